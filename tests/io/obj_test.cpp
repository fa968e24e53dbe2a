#include "tests/io/mesh_files.h"

#include <algorithm>
#include <array>

namespace snell {
namespace {

using namespace test;

const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

Scene load(const std::string& text)
{
    const Folder folder;
    return load_scene(folder.write("a.obj", text));
}

Scene load_with_mtl(const std::string& text, const std::string& mtl)
{
    const Folder folder;
    folder.write("a.mtl", mtl);
    return load_scene(folder.write("a.obj", text));
}

// The material that these MTL statements make.
MaterialDesc material(const std::string& statements)
{
    const Scene scene = load_with_mtl(corners + "mtllib a.mtl\nusemtl it\nf 1 2 3\n", "newmtl it\n" + statements);
    return *find_material(scene, "it");
}

TEST(Obj, IndicesOfAllKinds)
{
    const std::string attributes = "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n";
    struct Case
    {
        const char* face;
        bool has_uvs, has_normals;
    };
    for (const Case& c :
         {Case{"f 1 2 3", false, false}, Case{"f 1/1 2/2 3/3", true, false}, Case{"f 1//1 2//1 3//1", false, true},
          Case{"f 1/1/1 2/2/1 3/3/1", true, true}, Case{"f -4 -3 -2", false, false},
          Case{"f -4/-3/-1 -3/-2/-1 -2/-1/-1", true, true}, Case{"  f\t1  2\t3  ", false, false},
          Case{"f 1 \\\n 2 3", false, false}, Case{"f 1/ 2// 3", false, false}, Case{"f 1//1 2//1 3", false, false},
          Case{"f 1 2 3 # a comment", false, false}, Case{"fo 1 2 3", false, false},
          Case{"f 1/1 2/2 3/3\r", true, false}}) {
        SCOPED_TRACE(c.face);
        const Scene scene = load("\xEF\xBB\xBF" + corners + attributes + c.face + "\n");
        ASSERT_EQ(triangle_count(scene), 1u);
        const Mesh& mesh = scene.meshes[0];
        ASSERT_EQ(mesh.positions.size(), 3u);
        EXPECT_EQ(mesh.positions[2], vec3(1, 1, 0));
        ASSERT_EQ(mesh.uvs.size(), c.has_uvs ? 3u : 0u);
        if (c.has_uvs) {
            EXPECT_EQ(mesh.uvs[1], vec2(1, 0));
        }
        ASSERT_EQ(mesh.normals.size(), c.has_normals ? 3u : 0u);
        if (c.has_normals) {
            EXPECT_EQ(mesh.normals[1], vec3(0, 0, 1));
        }
    }
    // A positive index may refer to what comes later, a negative one counts from where it stands.
    EXPECT_EQ(triangle_count(load("f 1 2 3\n" + corners)), 1u);
    EXPECT_EQ(load(corners + "f -4 -3 -2\nv 9 9 9\n").meshes[0].positions[0], vec3(0));
}

TEST(Obj, VerticesAreSharedExactlyWhereAllTheirAttributesAre)
{
    EXPECT_EQ(load(corners + "f 1 2 3\nf 1 3 4\n").meshes[0].positions.size(), 4u);
    EXPECT_EQ(load(corners + "vt 0 0\nvt 1 1\nf 1/1 2/1 3/1\nf 1/2 3/1 4/1\n").meshes[0].positions.size(), 5u);
}

TEST(Obj, ConcavePolygonsAndLargeOnes)
{
    const Scene l = load("v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 6 1 2 3 4 5\n");
    EXPECT_EQ(triangle_count(l), 4u);
    EXPECT_NEAR(mesh_area(l.meshes[0]), 5.0, 1e-6);

    std::string disc, face = "f";
    for (int i = 0; i < 1000; ++i) {
        const double a = 6.283185307179586 * i / 1000;
        disc += fmt::format("v {} 0 {}\n", std::cos(a), -std::sin(a));
        face += fmt::format(" {}", i + 1);
    }
    const Scene scene = load(disc + face + "\n");
    EXPECT_EQ(triangle_count(scene), 998u);
    EXPECT_NEAR(mesh_area(scene.meshes[0]), 3.14157, 1e-4);
    EXPECT_GT(triangle_normal(scene.meshes[0], 500).y, 0.99f);
}

TEST(Obj, ObjectsGroupsAndMaterialsPerTriangle)
{
    const std::string faces = "usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\n";
    const Scene groups = load_with_mtl("mtllib a.mtl\n" + corners + "g left arm\n" + faces + "g right\n" + faces +
                                           "g left arm\nf 1 2 4\n",
                                       "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\nnewmtl unused\nmap_Kd no.png\n");
    ASSERT_EQ(groups.meshes.size(), 2u);
    EXPECT_EQ(groups.meshes[0].name, "left arm");
    EXPECT_EQ(groups.meshes[0].triangles.size(), 3u);
    EXPECT_EQ(groups.meshes[0].triangle_materials.size(), 3u);
    EXPECT_EQ(groups.materials.size(), 2u);
    EXPECT_EQ(groups.materials[groups.meshes[0].triangle_materials[2].value].name, "blue");
    EXPECT_EQ(groups.instances.size(), 1u);
    EXPECT_TRUE(groups.notes.empty()) << groups.notes[0].text;

    // In a file with objects the groups within them do not count.
    const Scene objects = load(corners + "o one\ng a\nf 1 2 3\ng b\nf 1 3 4\no two\nf 1 2 3\n");
    ASSERT_EQ(objects.meshes.size(), 2u);
    EXPECT_EQ(objects.meshes[1].name, "two");
}

TEST(Obj, SmoothingGroups)
{
    // A roof: two squares that meet at a right angle along the edge 1 2.
    const std::string roof = "v 0 0 0\nv 0 1 0\nv -1 1 -1\nv -1 0 -1\nv 1 0 -1\nv 1 1 -1\n";
    const std::string left = "f 1 2 3 4\n", right = "f 2 1 5 6\n";
    EXPECT_TRUE(load(roof + left + right).meshes[0].normals.empty());
    EXPECT_TRUE(load(roof + "s 1\ns off\n" + left + "s 0\n" + right).meshes[0].normals.empty());

    const Mesh smooth = load(roof + "s 1\n" + left + right).meshes[0];
    ASSERT_EQ(smooth.positions.size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
        const bool is_ridge = smooth.positions[i].x == 0.0f;
        EXPECT_NEAR(smooth.normals[i].z, is_ridge ? 1.0f : std::sqrt(0.5f), 1e-6f);
    }
    // Two groups: nothing is averaged, and the ridge has two normals.
    EXPECT_EQ(load(roof + "s 1\n" + left + "s 2\n" + right).meshes[0].positions.size(), 8u);
    // A flat face beside a smooth one keeps its own normal.
    const Mesh half = load(roof + "s on\n" + left + "s off\n" + right).meshes[0];
    ASSERT_EQ(half.positions.size(), 8u);
    for (std::size_t i = 4; i < 8; ++i) EXPECT_NEAR(dot(half.normals[i], vec3(1, 0, 1)), std::sqrt(2.0f), 1e-6f);
    // By angle: a square cut into two triangles weighs as much as one that is not.
    const Mesh cut = load(roof + "s 1\n" + left + "f 2 1 5\nf 2 5 6\n").meshes[0];
    for (std::size_t i = 0; i < 6; ++i)
        if (cut.positions[i].x == 0.0f) {
            EXPECT_NEAR(cut.normals[i].z, 1.0f, 1e-5f);
        }
    // Normals in the file win.
    EXPECT_EQ(load(roof + "vn 0 1 0\ns 1\nf 1//1 2//1 3//1\n").meshes[0].normals.at(0), vec3(0, 1, 0));
}

TEST(Obj, VertexColors)
{
    const Mesh mesh = load("v 0 0 0 1 0.5 0\nv 1 0 0 0 0 1\nv 0 1 0\nf 1 2 3\n").meshes[0];
    ASSERT_EQ(mesh.colors.size(), 3u);
    EXPECT_EQ(mesh.colors[0], vec4(1, 0.5f, 0, 1));
    EXPECT_EQ(mesh.colors[2], vec4(1));
    const Scene bytes = load("v 0 0 0 255 51 0\nv 1 0 0 0 0 1\nv 0 1 0 0 0 0\nf 1 2 3\n");
    EXPECT_NEAR(bytes.meshes[0].colors.at(0).y, 0.2f, 1e-6f);
    EXPECT_TRUE(has_note(bytes, "taken as 0 to 255"));
    EXPECT_TRUE(load("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n").meshes[0].colors.empty()); // w
}

TEST(Obj, MaterialKinds)
{
    const MaterialDesc diffuse = material("Kd 0.2 0.4 0.6\nKs 0 0 0\nNs 10\nNi 1.5\nd 1\nTr 0\nTf 1 1 1\nillum 2\n");
    EXPECT_EQ(diffuse.kind, material_diffuse);
    EXPECT_EQ(diffuse.base_color, vec3(0.2f, 0.4f, 0.6f));
    EXPECT_EQ(material("Kd 0.5\n").base_color, vec3(0.5f)); // one number is grey
    EXPECT_EQ(material("").base_color, vec3(0.8f));
    EXPECT_EQ(material("Kd .3 .3 .3\nKs 1 1 1\nillum 1\n").kind, material_diffuse);

    const MaterialDesc glossy = material("Kd 0.6 0.6 0.6\nKs 0.6 0.6 0.6\nNs 98\nillum 2\n");
    EXPECT_EQ(glossy.kind, material_mix);
    EXPECT_NEAR(glossy.base_color.x, 0.5f, 1e-6f); // scaled: 1 together
    EXPECT_NEAR(glossy.specular.x, 0.5f, 1e-6f);
    EXPECT_NEAR(glossy.alpha, std::sqrt(0.02f), 1e-6f);
    EXPECT_EQ(material("Kd .5 .5 .5\nKs .2 .2 .2\nillum 3\n").alpha, 0.0f);

    const MaterialDesc mirror = material("Kd 0.01 0.01 0.01\nKs 0.95 0.95 0.95\nNs 1000\nillum 5\n");
    EXPECT_EQ(mirror.kind, material_mirror);
    EXPECT_EQ(mirror.base_color, vec3(0.95f));

    const MaterialDesc glass = material("Kd 0.01 0.01 0.01\nKs 0.3 0.3 0.3\nTf 0.1 0.1 0.1\nNi 2.5\nillum 7\n");
    EXPECT_EQ(glass.kind, material_dielectric);
    EXPECT_EQ(glass.ior, 2.5f);
    EXPECT_EQ(glass.base_color, vec3(1.0f));
    EXPECT_NEAR(material("Tf 0.2 0.8 0.2\nillum 6\n").base_color.x, 0.5f, 1e-6f); // sqrt(0.25), at each surface
    EXPECT_EQ(material("illum 4\n").ior, 1.5f);
    const MaterialDesc veil = material("Kd 1 0 0\nd 0.75\n");
    EXPECT_EQ(veil.kind, material_dielectric);
    EXPECT_EQ(veil.ior, 1.0f);
    EXPECT_NEAR(veil.base_color.y, 0.5f, 1e-6f);
    EXPECT_EQ(material("Tr 0.5\nNi 1.3\n").ior, 1.3f);
    EXPECT_EQ(material("d -halo 1.0\n").kind, material_diffuse);
    EXPECT_NEAR(material("Kd 1 0 0\nd -halo 0.75\n").base_color.y, 0.5f, 1e-6f);

    const MaterialDesc light = material("Kd 0.78 0.78 0.78\nKe 17 12 4\n");
    EXPECT_EQ(light.emission, vec3(17, 12, 4));
    EXPECT_FALSE(light.two_sided_emission);
}

TEST(Obj, MtlDialects)
{
    // Names with spaces, tabs, trailing blanks, Windows' line ends.
    const Folder folder;
    folder.write("my library.mtl", "  newmtl light wood \r\n\tKd 0.1 0.2 0.3\r\n");
    folder.write("other.mtl", "newmtl two\nKd 0 1 0\nnewmtl two\nKd 1 0 0\n");
    const std::string faces = "usemtl light wood  \nf 1 2 3\nusemtl two\nf 1 3 4\n";
    const Scene scene =
        load_scene(folder.write("a.obj", corners + "mtllib My Library.mtl\nmtllib none.mtl other.mtl\n" + faces));
    EXPECT_EQ(find_material(scene, "light wood")->base_color, vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(find_material(scene, "two")->base_color, vec3(0, 1, 0));
    EXPECT_TRUE(has_note(scene, "a.obj:6: the material library 'none.mtl' is not there"));

    const Scene damaged = load_with_mtl(corners + "mtllib a.mtl\nusemtl it\nf 1 2 3\nusemtl lost\nf 1 2 4\n",
                                        "newmtl it\nKd 0.5 zero 0\nNs nan\nKd spectral x.rfl\n");
    EXPECT_EQ(find_material(damaged, "it")->base_color, vec3(0.8f));
    EXPECT_TRUE(has_note(damaged, "a.mtl:2: 'Kd' wants 3 numbers"));
    EXPECT_TRUE(has_note(damaged, "a.mtl:3: 'Ns' wants 1 number"));
    EXPECT_TRUE(has_note(damaged, "no library has the material 'lost'"));
    EXPECT_EQ(find_material(damaged, "lost")->base_color, vec3(0.8f));
}

TEST(Obj, Textures)
{
    const Folder folder;
    // A TGA of one red texel.
    const std::string tga("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\0\0\0\xff", 21);
    folder.write("Red Brick.tga", tga);
    folder.write_folder("Maps");
    folder.write("Maps/Blue.tga", tga);
    folder.write("a.mtl",
                 "newmtl a\nmap_Kd -clamp on textures\\red brick.TGA\nnewmtl b\nKd 0 0 0\nmap_Kd \"Red Brick.tga\"\n"
                 "newmtl c\nKd .5 .5 .5\nmap_Kd missing.png\nmap_bump bump.png\nnewmtl d\nmap_Kd missing.png\n"
                 "newmtl e\nmap_Kd a.mtl\nnewmtl f\nmap_Kd MAPS/blue.TGA\n");
    std::string faces;
    for (const char* name : {"a", "b", "c", "d", "e", "f"}) faces += fmt::format("usemtl {}\nf 1/1 2/2 3/3\n", name);
    const Scene scene = load_scene(folder.write("a.obj", corners + "vt 0 0\nvt 1 0\nvt 1 1\nmtllib a.mtl\n" + faces));
    const auto image = [&](const char* name) {
        return scene.images.at(find_material(scene, name)->base_texture.image.value);
    };
    EXPECT_EQ(image("a").width, 1u);
    EXPECT_EQ(find_material(scene, "a")->base_texture.wrap_u, wrap_clamp);
    EXPECT_EQ(find_material(scene, "a")->base_texture.wrap_v, wrap_clamp);
    EXPECT_EQ(find_material(scene, "b")->base_texture.wrap_u, wrap_repeat);
    EXPECT_EQ(image("b").bytes.at(0), 255);
    EXPECT_EQ(find_material(scene, "b")->base_color, vec3(1.0f)); // nobody textures black
    EXPECT_EQ(image("c").width, 8u);
    EXPECT_EQ(find_material(scene, "c")->base_texture, find_material(scene, "d")->base_texture);
    EXPECT_EQ(image("e").width, 8u);
    EXPECT_EQ(image("f").width, 1u);
    EXPECT_TRUE(has_note(scene, "the texture 'missing.png' is not there; a magenta checkerboard"));
    EXPECT_EQ(std::count_if(scene.notes.begin(), scene.notes.end(),
                            [](const Note& n) { return n.text.find("missing.png") != std::string::npos; }),
              1);
    // A picture with two names missing is said once each, whatever is to be made of it.
    EXPECT_TRUE(has_note(scene, "the texture 'bump.png' is not there; it is left out"));
    EXPECT_FALSE(find_material(scene, "c")->normal_texture.valid());
}

// A TGA of one row: blue, green, red, alpha of each texel.
std::string tga_of(const std::vector<std::array<int, 4>>& texels)
{
    std::string tga("\0\0\2\0\0\0\0\0\0\0\0\0\0\0\1\0\x20\x08", 18);
    tga[12] = static_cast<char>(texels.size());
    for (const auto& texel : texels)
        for (const int value : texel) tga += static_cast<char>(value);
    return tga;
}

TEST(Obj, MaterialsOfThePhysicalExtension)
{
    const MaterialDesc metal = material("Kd 1 0.8 0.2\nPm 1\nPr 0.3\n");
    EXPECT_EQ(metal.kind, material_principled);
    EXPECT_EQ(metal.base_color, vec3(1, 0.8f, 0.2f));
    EXPECT_EQ(metal.principled.metallic, 1.0f);
    EXPECT_EQ(metal.principled.roughness, 0.3f);
    EXPECT_EQ(metal.ior, 1.5f);

    const MaterialDesc all = material("Kd .5 .5 .5\nKs .25 .25 .25\nNs 98\nNi 1.4\nPs .5\nPc .6\nPcr .7\naniso .8\n"
                                      "anisor .25\nd .9\n");
    EXPECT_EQ(all.ior, 1.4f);
    EXPECT_NEAR(all.principled.roughness, std::pow(0.02f, 0.25f), 1e-6f); // no Pr: from Ns
    EXPECT_EQ(all.principled.specular, 0.5f);
    EXPECT_EQ(all.principled.sheen_color, vec3(0.5f));
    EXPECT_GT(all.principled.sheen_roughness, 0.0f);
    EXPECT_EQ(all.principled.clearcoat, 0.6f);
    EXPECT_EQ(all.principled.clearcoat_roughness, 0.7f);
    EXPECT_EQ(all.principled.anisotropy, 0.8f);
    EXPECT_NEAR(all.principled.anisotropy_rotation, 1.5707963f, 1e-6f);
    EXPECT_EQ(all.coverage, coverage_blend);
    EXPECT_EQ(all.opacity, 0.9f);

    const MaterialDesc glass = material("Kd 1 1 1\nPr 0\nPm 0\nNi 1.33\nillum 7\n");
    EXPECT_EQ(glass.kind, material_principled);
    EXPECT_EQ(glass.principled.transmission, 1.0f);
    EXPECT_FALSE(glass.principled.thin_walled);
    EXPECT_EQ(glass.coverage, coverage_opaque);
}

TEST(Obj, MapsOfAllKinds)
{
    const Folder folder;
    const std::array<int, 4> grey = {90, 90, 90, 255}, white = {255, 255, 255, 255}, bluish = {255, 128, 128, 255};
    folder.write("grey.tga", tga_of({grey, white, white, grey}));
    folder.write("hole.tga", tga_of({{10, 20, 30, 0}, white}));
    folder.write("normals.tga", tga_of({bluish, bluish}));
    folder.write("a.mtl",
                 "newmtl a\nKd 1 1 1\nmap_Kd -s 2 3 1 -o 0.25 0.5 0 grey.tga\nmap_d grey.tga\n"
                 "map_Bump -bm 0.5 normals.tga\nmap_Ke grey.tga\nmap_Ks grey.tga\n"
                 "newmtl b\nmap_d -imfchan g hole.tga\nbump -bm 2 grey.tga\n"
                 "newmtl c\nPr 0\nmap_Pr grey.tga\nmap_Pm -mm 0 2 grey.tga\nnorm normals.tga\nmap_d hole.tga\n");
    std::string text = corners + "vt 0 0\nmtllib a.mtl\n";
    for (const char* name : {"a", "b", "c"}) text += fmt::format("usemtl {}\nf 1/1 2/1 3/1\n", name);
    const Scene scene = load_scene(folder.write("a.obj", text));
    const MaterialDesc &a = *find_material(scene, "a"), &b = *find_material(scene, "b"),
                       &c = *find_material(scene, "c");

    EXPECT_EQ(a.base_texture.row_u, vec3(2, 0, 0.25f));
    EXPECT_EQ(a.base_texture.row_v, vec3(0, 3, 0.5f));
    EXPECT_EQ(a.coverage, coverage_blend);
    EXPECT_EQ(a.opacity_texture.channel, 0u);
    EXPECT_EQ(a.emission, vec3(1.0f)); // a map of light without Ke
    EXPECT_TRUE(a.emission_texture.valid());
    EXPECT_EQ(a.normal_scale, 0.5f);
    const Image& normals = scene.images[a.normal_texture.image.value];
    EXPECT_EQ(normals.format, texels_rgba8_linear);
    EXPECT_EQ(normals.bytes[2], 255);                         // taken as it is
    EXPECT_NE(a.base_texture.image, a.opacity_texture.image); // colours and numbers are decoded differently
    EXPECT_TRUE(has_note(scene, "maps that are not used: 'a' has map_Ks"));

    EXPECT_EQ(b.opacity_texture.channel, 1u);
    EXPECT_EQ(c.opacity_texture.channel, 3u); // the picture has an alpha channel
    EXPECT_EQ(b.normal_scale, 2.0f);
    // Heights: a rise towards +u tilts the normal towards -u.
    const Image& bump = scene.images[b.normal_texture.image.value];
    EXPECT_TRUE(has_note(scene, "'grey.tga' is a height map"));
    const double rise = 0.5 * (255 - 90) / 255.0, size = std::sqrt(1 + rise * rise);
    EXPECT_NEAR(bump.bytes[0], 127.5 - 127.5 * rise / size, 1.0);
    EXPECT_NEAR(bump.bytes[1], 127.5, 1.0);
    EXPECT_NEAR(bump.bytes[2], 127.5 + 127.5 / size, 1.0);

    EXPECT_EQ(c.kind, material_principled);
    EXPECT_EQ(c.principled.roughness, 1.0f); // what its map would multiply to nothing
    EXPECT_TRUE(c.principled.roughness_texture.valid());
    EXPECT_TRUE(c.principled.metallic_texture.valid());
    EXPECT_TRUE(c.normal_texture.valid());
    EXPECT_TRUE(has_note(scene, "the option -mm of textures is not used"));
}

// Text in UTF-16, with byte order mark.
std::string utf16(std::u16string_view text, bool is_big)
{
    std::string bytes;
    for (const char16_t unit : std::u16string(u"\uFEFF") + std::u16string(text)) {
        const char low = static_cast<char>(unit & 0xff), high = static_cast<char>(unit >> 8);
        bytes += is_big ? high : low;
        bytes += is_big ? low : high;
    }
    return bytes;
}

TEST(Obj, Utf16)
{
    const Folder folder;
    for (const bool is_big : {false, true}) {
        folder.write("a.mtl", utf16(u"newmtl gr\u00fcn \U0001F422\r\nKd 0 1 0\r\n", is_big));
        const Scene scene = load_scene(folder.write("a.obj", utf16(u"mtllib a.mtl\r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\n"
                                                                   u"usemtl gr\u00fcn \U0001F422\r\nf 1 2 3\r\n",
                                                                   is_big)));
        EXPECT_EQ(triangle_count(scene), 1u);
        ASSERT_NE(find_material(scene, "gr\u00fcn \U0001F422"), nullptr);
        EXPECT_EQ(find_material(scene, "gr\u00fcn \U0001F422")->base_color, vec3(0, 1, 0));
        EXPECT_TRUE(scene.notes.empty()) << scene.notes[0].text;
        EXPECT_NE(load_error(folder.write("a.obj", utf16(u"v 0 0 0\nv 0 x 0\n", is_big))).find("a.obj:2:5"),
                  std::string::npos);
    }
}

TEST(Obj, NamesWithSpacesAndMissingFilesAreSaidOnce)
{
    const Folder folder;
    std::string mtl, text = corners + "vt 0 0\nmtllib my materials.mtl\n";
    for (int i = 0; i < 50; ++i) {
        mtl += fmt::format("newmtl wall {}\nmap_Kd my pictures/no such wall.png\n", i);
        text += fmt::format("usemtl wall {}\nf 1/1 2/1 3/1\n", i);
    }
    folder.write("my materials.mtl", mtl);
    const Scene scene = load_scene(folder.write("a.obj", text));
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_TRUE(has_note(scene, "my materials.mtl:2: the texture 'my pictures/no such wall.png' is not there"));
    EXPECT_EQ(scene.materials.size(), 50u);
    ASSERT_EQ(scene.images.size(), 1u);
    const std::vector<std::uint8_t>& texels = scene.images[0].bytes;
    EXPECT_EQ(std::vector<std::uint8_t>(texels.begin(), texels.begin() + 8),
              (std::vector<std::uint8_t>{255, 0, 255, 255, 0, 0, 0, 255}));
}

TEST(Obj, TheSandboxEndsAtTheFolder)
{
    const Folder folder;
    folder.write("red.tga", tga_of({{0, 0, 255, 255}}));
    folder.write_folder("inner");
    folder.write("inner/a.mtl", "newmtl a\nmap_Kd ../red.tga\n");
    const auto obj = folder.write("inner/a.obj", corners + "vt 0 0\nmtllib a.mtl\nusemtl a\nf 1/1 2/1 3/1\n");
    const Scene scene = load_scene(obj);
    EXPECT_EQ(scene.images.at(0).width, 1u);
    EXPECT_TRUE(has_note(scene, "'../red.tga' leads out of the scene's folder"));
    LoadOptions options;
    options.sandbox = true;
    EXPECT_THROW(load_scene(obj, options), Error);
}

// A long file whose pieces are read by several threads is what its lines are one by one.
TEST(Obj, LargeFilesAreReadInPieces)
{
    constexpr int rows = 60000;
    std::string text = "# padding so that pieces end where nobody thought of\n";
    std::size_t faces = 0;
    for (int i = 0; i < rows; ++i) {
        text += fmt::format("v {} 0 0.5\nv {} 1 0.5\nvt {} 0\nvt {} 1\n", i, i, i, i);
        if (i % 1000 == 0) text += fmt::format("o part {}\nusemtl m{}\n", i / 10000, i % 7);
        if (i == 0) continue;
        ++faces;
        // Absolute, relative and continued; each quad is one piece of a ribbon.
        const int a = 2 * i - 1;
        if (i % 3 == 0)
            text += fmt::format("f {0}/{0} {1}/{1} {2}/{2} {3}/{3}\n", a, a + 2, a + 3, a + 1);
        else if (i % 3 == 1)
            text += "f -4/-4 -2/-2 -1/-1 -3/-3\r\n";
        else
            text += "f -4/-4 \\\n -2/-2 -1/-1 \\\r\n-3/-3\n";
    }
    ASSERT_GT(text.size(), std::size_t{3} << 20);
    const Folder folder;
    const Scene scene = load_scene(folder.write("a.obj", text));
    ASSERT_EQ(scene.meshes.size(), 6u);
    EXPECT_EQ(triangle_count(scene), 2 * faces);
    double area = 0;
    for (const Mesh& mesh : scene.meshes) {
        area += mesh_area(mesh);
        for (std::size_t i = 0; i < mesh.positions.size(); ++i)
            ASSERT_EQ(mesh.uvs[i], vec2(mesh.positions[i].x, mesh.positions[i].y));
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) ASSERT_EQ(triangle_normal(mesh, i), vec3(0, 0, 1));
    }
    EXPECT_NEAR(area, rows - 1, 1e-3);

    // Errors in the last piece know their line.
    const auto lines = std::count(text.begin(), text.end(), '\n');
    EXPECT_NE(load_error(folder.write("b.obj", text + "\nf 1 2 x\n")).find(fmt::format("b.obj:{}:7: ", lines + 2)),
              std::string::npos);
    EXPECT_NE(load_error(folder.write("b.obj", text + "f -200000 -1 -2\n")).find(fmt::format("b.obj:{}: ", lines + 1)),
              std::string::npos);
    EXPECT_NE(load_error(folder.write("b.obj", "f 1 2 200000\n" + text)).find("b.obj:1: vertex 200000"),
              std::string::npos);
}

TEST(Obj, LinesLongerThanAnyWindowTakeLinearTime)
{
    std::string continued = corners + "f 1 2 \\\n";
    for (int i = 0; i < 5000000; ++i) continued += "\\\n";
    EXPECT_EQ(triangle_count(load(continued + " 3\nf 1 3 4\n")), 2u);
    const std::string long_name(std::size_t{10} << 20, 'x');
    EXPECT_EQ(load(corners + "o " + long_name + "\nf 1 2 3\n").meshes[0].name.size(), long_name.size());
}

TEST(Obj, ProgressGoesFromTheBeginningToTheEnd)
{
    std::string text = corners + "f 1 2 3\n";
    while (text.size() < std::size_t{17} << 20) text += "# many words that say nothing, as some exporters like them\n";
    const Folder folder;
    std::vector<double> told;
    LoadOptions options;
    options.progress = [&](const LoadProgress& progress) {
        if (progress.what == "reading a.obj") told.push_back(progress.fraction);
    };
    load_scene(folder.write("a.obj", text), options);
    ASSERT_GE(told.size(), 3u);
    EXPECT_TRUE(std::is_sorted(told.begin(), told.end()));
    EXPECT_EQ(told.front(), 0.0);
    EXPECT_NEAR(told.back(), 0.9, 1e-9);
    EXPECT_TRUE(std::any_of(told.begin(), told.end(), [](double part) { return part > 0.3 && part < 0.88; }));
}

TEST(Obj, FacesBeforeAndBetweenTheirVertices)
{
    const Mesh mesh =
        load("f 1/1 2/1 3/1\nv 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nf 1/1 3/1 4/1\nv 0 1 0\nf 1/1 2/1 4/1\n").meshes[0];
    EXPECT_EQ(mesh.positions.size(), 4u); // still shared
    EXPECT_EQ(mesh.triangles.size(), 3u);
}

TEST(Obj, WhatIsSkippedIsSaid)
{
    const Scene scene =
        load(corners + "l 1 2\np 1\nl 2 3\ncstype bezier\nsurf 0 1 0 1 1 2 3\nwhatever 1\nf 1 2\nf 1 2 3\n");
    EXPECT_TRUE(has_note(scene, "a.obj:5: lines and points are not drawn (3 such lines)"));
    EXPECT_TRUE(has_note(scene, "a.obj:8: free-form"));
    EXPECT_TRUE(has_note(scene, "a.obj:10: unknown keywords are skipped (1 such line)"));
    EXPECT_TRUE(has_note(scene, "a.obj:11: 1 faces have less than three corners"));
    const Scene nan = load(corners + "v nan 0 -1.#IND\nf 1 2 3\nf 1 2 5\n");
    EXPECT_EQ(triangle_count(nan), 1u);
    EXPECT_TRUE(has_note(nan, "a.obj:5: numbers that are not finite (1 such line)"));
}

TEST(Obj, ErrorsSayWhereAndWhat)
{
    const Folder folder;
    const auto expect = [&](const std::string& text, std::string_view part) {
        const std::string error = load_error(folder.write("a.obj", text));
        EXPECT_NE(error.find(part), std::string::npos) << "got: " << error << "\nwanted: " << part;
    };
    expect("", "neither vertices nor faces");
    expect(corners, "4 points, but no faces");
    expect("v 1 2\n", "a.obj:1: 2 numbers where there should be 3");
    expect("v 1 2 3\nv 1 two 3\n", "a.obj:2:5: a number should be here, but there is 'two'");
    expect("v 1 2,5 3\n", "'2,5'");
    expect("v 1 2 3e99999999999\n", "a.obj:1:7: a number");
    expect("v 1 2 3 4 5 6 7 8\n", "more than 7 numbers");
    expect(corners + "f 1 2 5\n", "a.obj:5: vertex 5 is referred to, but the file has 4");
    expect(corners + "f 1 2 999999999\n", "vertex 999999999");
    expect(corners + "f 1 2 -5\n", "a.obj:5: vertex -5 is referred to, but there are only 4 before this line");
    expect(corners + "f 0 1 2\n", "a.obj:5:3: vertex 0");
    expect(corners + "f 1 2 2147483648\n", "a.obj:5:7: a face's corner");
    expect(corners + "f 1 2 -2147483648\n", "a face's corner");
    expect(corners + "f 1 2 x\n", "'x'");
    expect(corners + "f 1/2/3/4 2 3\n", "'1/2/3/4'");
    expect(corners + "f 1/7 2/7 3/7\n", "texture coordinate 7");
    expect(corners + "f 1//7 2//7 3//7\n", "normal 7");
    expect(corners + "s many\n", "a.obj:5:3: a smoothing group");
    expect(std::string("v 1 2 \0003\n", 9), "a number should be here");
}

TEST(Obj, NastyFilesTakeLittleTimeAndMemory)
{
    std::string text = corners + "f 1 2 3\n";
    for (int i = 0; i < 20000; ++i) text += "l 1 2\nusemtl a\nt x 8192/8192/8192\nmtllib b.mtl\nvw 0 1e99 0\n";
    EXPECT_EQ(triangle_count(load(text)), 1u);
    // All corners of one position: a list per position would make this quadratic.
    std::string pile = corners;
    for (int i = 0; i < 20000; ++i) pile += fmt::format("vt {} 0\n", i);
    for (int i = 1; i < 20000; ++i) pile += fmt::format("f 1/{0} 2/{0} 3/{0}\n", i);
    EXPECT_EQ(triangle_count(load(pile)), 19999u);
    std::string mac = pile;
    std::replace(mac.begin(), mac.end(), '\n', '\r');
    EXPECT_EQ(triangle_count(load(mac)), 19999u);
}

TEST(Obj, DamagedFilesEndInASceneOrAnError)
{
    damage("damaged.obj",
           "mtllib a.mtl\no thing\nv 0 0 0 1 0 0\nv 1 0 0\nv 1.5 1e0 -0.25\nv 0 1 0\nv .5 .5 1\nvt 0 0\nvt 1 0.5\n"
           "vn 0 0 1\nvn 0 1 0\ng top\nusemtl red\ns 1\nf 1 2 3 4\nf -1/1/1 -2/2/2 -3/1/1\ns off\n"
           "f 1 2 \\\n 5\nf 1//1 2//2 3//1 4//2 5//1\nl 1 2\nf 5 4 3 2 1\n");
}

TEST(Obj, DamagedLibrariesEndInASceneOrAnError)
{
    const Folder folder;
    const std::string mtl =
        "newmtl red\nKd 1 0 0\nKs .5 .5 .5\nNs 100\nNi 1.5\nd 1\nillum 2\nTf 1 1 1\nKe 1 2 3\nPr .5\nPm 1\n"
        "map_Kd -s 1 1 1 -o 0 0 -mm 0 1 -texres 4 -type sphere -imfchan r -clamp on -bm 1 a.png\n";
    const auto obj = folder.write("a.obj", corners + "mtllib a.mtl\nusemtl red\nf 1 2 3\n");
    std::uint32_t state = 1;
    for (std::size_t i = 0; i < 2 * mtl.size(); ++i) {
        std::string damaged = mtl;
        state = state * 1664525u + 1013904223u;
        if (i < mtl.size())
            damaged.resize(i);
        else
            damaged[i - mtl.size()] = static_cast<char>(state >> 24);
        folder.write("a.mtl", damaged);
        const Scene scene = load_scene(obj);
        ASSERT_EQ(triangle_count(scene), 1u);
    }
}

TEST(Obj, FilesOfTheWorld)
{
    struct Expected
    {
        const char* file;
        std::size_t triangles, materials;
    };
    for (const Expected& e :
         {Expected{"stanford_bunny/bunny.obj", 69451, 1}, Expected{"stanford_armadillo/armadillo.obj", 86482, 1},
          Expected{"stanford_buddha/buddha_100k.obj", 100000, 1}, Expected{"utah_teapot/teapot.obj", 6320, 1},
          Expected{"suzanne/suzanne.obj", 968, 1}, Expected{"spot/spot_control_mesh.obj", 372, 1},
          Expected{"spot/spot_quadrangulated.obj", 5856, 1}, Expected{"spot/spot_triangulated.obj", 5856, 1},
          Expected{"obj_small/cornell_box.obj", 36, 4}, Expected{"obj_small/cube-vertexcol.obj", 12, 3},
          Expected{"obj_small/no_material.obj", 36, 1}, Expected{"obj_small/smoothing-normal.obj", 6, 1},
          Expected{"cornell_box_mcguire/CornellBox-Water.obj", 7088, 9},
          Expected{"cornell_box_mcguire/water.obj", 4900, 1},
          // One of the 66,450 triangles has no area.
          Expected{"sponza_dabrovic/sponza.obj", 66449, 20}})
        if (const auto file = shared_mesh(e.file); !file.empty()) {
            const Scene scene = load_scene(file);
            EXPECT_EQ(triangle_count(scene), e.triangles) << e.file;
            EXPECT_EQ(scene.materials.size(), e.materials) << e.file;
        }
    if (const auto file = shared_mesh("spot/spot_quadrangulated.obj"); !file.empty()) {
        EXPECT_EQ(load_scene(file).meshes[0].uvs.size(), 3225u);
    }
}

TEST(Obj, CornellBoxesShineDown)
{
    for (const char* name :
         {"Empty-CO", "Empty-RG", "Empty-Squashed", "Empty-White", "Glossy", "Mirror", "Original", "Sphere", "Water"}) {
        const auto file = shared_mesh(fmt::format("cornell_box_mcguire/CornellBox-{}.obj", name));
        if (file.empty()) continue;
        const Scene scene = load_scene(file);
        EXPECT_TRUE(scene.notes.empty()) << name << ": " << scene.notes[0].text;
        EXPECT_NEAR(scene_bounds(scene).extent().x, 2.02f, 0.01f) << name;
        std::size_t lights = 0;
        for (const Mesh& mesh : scene.meshes) {
            if (is_black(scene.materials[mesh.material.value].emission)) continue;
            EXPECT_EQ(mesh.name, "light") << name;
            for (std::size_t i = 0; i < mesh.triangles.size(); ++i, ++lights)
                EXPECT_LT(triangle_normal(mesh, i).y, -0.99f) << name;
        }
        EXPECT_EQ(lights, 2u) << name;
    }
    const auto file = shared_mesh("cornell_box_mcguire/CornellBox-Sphere.obj");
    if (file.empty()) return;
    const Scene scene = load_scene(file);
    EXPECT_EQ(find_material(scene, "leftSphere")->kind, material_mirror);
    EXPECT_EQ(find_material(scene, "rightSphere")->kind, material_dielectric);
}

} // namespace
} // namespace snell
