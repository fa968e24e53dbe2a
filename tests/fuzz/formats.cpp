#include "formats.h"

#include "seeds.h"

#include "snell/io/calibration.h"
#include "snell/io/image/read.h"
#include "snell/io/lens_file.h"
#include "snell/io/load.h"
#include "snell/scene/camera_models.h"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace fs = std::filesystem;

namespace snell::hostile {

namespace {

const char* const triangle_ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                                 "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                                 "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

const char* const mesh_obj =
    "mtllib mesh.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl red\nf 1/1 2/2 "
    "3/3\nusemtl glass\nf 1/1 3/3 2/2\n";

const char* const spd_scene = "Camera \"perspective\" \"float fov\" 45\nWorldBegin\n"
                              "LightSource \"point\" \"spectrum I\" \"light.spd\"\n"
                              "Material \"conductor\" \"spectrum eta\" \"light.spd\" \"spectrum k\" \"light.spd\"\n"
                              "Shape \"sphere\"\n";

std::vector<Format> make_formats()
{
    const std::string png = small_png();
    const std::map<std::string, std::string> picture = {{"tex.png", png}};
    std::vector<Format> all = {
        {"gltf", "scene.gltf", "scene.gltf", true, false, picture},
        {"glb", "scene.glb", "scene.glb", false, false, picture},
        {"pbrt",
         "scene.pbrt",
         "scene.pbrt",
         true,
         false,
         {{"tex.png", png},
          {"mesh.ply", triangle_ply},
          {"part.pbrt", "Shape \"sphere\" \"float radius\" 2\n"},
          {"light.spd", "400 1\n700 2\n"}}},
        {"spd", "light.spd", "scene.pbrt", true, false, {{"scene.pbrt", spd_scene}}},
        {"obj",
         "mesh.obj",
         "mesh.obj",
         true,
         false,
         {{"tex.png", png}, {"mesh.mtl", "newmtl red\nKd 1 0 0\nmap_Kd tex.png\nnewmtl glass\nd 0.1\nNi 1.5\n"}}},
        {"mtl", "mesh.mtl", "mesh.obj", true, false, {{"tex.png", png}, {"mesh.obj", mesh_obj}}},
        {"ply", "mesh.ply", "mesh.ply"},
        {"stl", "mesh.stl", "mesh.stl"},
        {"gz", "mesh.ply.gz", "mesh.ply.gz"},
        {"lens", "lens.txt", "lens.txt", true},
        {"calibration", "calibration.yml", "calibration.yml", true},
    };
    for (const char* kind : {"exr", "png", "hdr", "pfm", "jpg", "tga", "bmp", "webp"})
        all.push_back({kind, std::string("a.") + kind, std::string("a.") + kind, false, true});
    return all;
}

void write(const fs::path& file, std::string_view bytes)
{
    fs::remove(file); // some file systems make overwriting wait for the disk
    std::ofstream out(file, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) throw std::runtime_error("cannot write " + file.string());
}

} // namespace

const std::vector<Format>& formats()
{
    static const std::vector<Format> all = make_formats();
    return all;
}

const Format* find_format(std::string_view name)
{
    for (const Format& format : formats())
        if (format.name == name) return &format;
    return nullptr;
}

Nest::Nest(const Format& format) : format_(format)
{
    std::string pattern = (fs::temp_directory_path() / ("snell-" + format.name + "-XXXXXX")).string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a folder " + pattern);
    folder_ = pattern;
    for (const auto& [name, bytes] : format.companions) write(folder_ / name, bytes);
}

Nest::~Nest()
{
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

void Nest::put(std::string_view bytes) const
{
    write(folder_ / format_.file, bytes);
}

std::optional<Error> Nest::open() const
{
    const fs::path file = folder_ / format_.main;
    try {
        if (format_.is_image) {
            const Picture picture = read_picture(file);
            const Image image = read_texture(file, false);
            const auto texels = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
            if (picture.pixels.size() != texels || image.bytes.size() + image.floats.size() != 4 * texels)
                throw std::logic_error("a picture with more or fewer texels than its size");
            return std::nullopt;
        }
        CameraDesc camera;
        if (format_.name == "lens") {
            camera.model = usual_model(camera_lens);
            camera.model.lens = load_lens(file);
        } else if (format_.name == "calibration") {
            camera.model = load_calibration(file);
        }
        if (camera.model.kind != camera_pinhole) { // what can be read can be looked through, or says why not
            if (camera_fault(camera).empty()) camera_ray(make_camera(camera, 64, 48), vec2(1.0f, 2.0f));
            return std::nullopt;
        }
        Scene scene = load_scene(file);
        complete(scene, 1.5f);
        validate(scene);
        return std::nullopt;
    } catch (const Error& error) {
        return error;
    }
}

} // namespace snell::hostile
