// What a scene may refer to: folders, devices, links in a circle, files outside, and nothing on a network.
#include "opened.h"

#include "snell/io/load.h"

#include <gtest/gtest.h>

#include <sys/stat.h>

#include <fstream>
#include <functional>

namespace fs = std::filesystem;

namespace snell::hostile {

namespace {

const std::string gltf_start =
    R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":)"
    R"({"POSITION":0}}]}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"componentType":5126,"type":"VEC3",)"
    R"("bufferView":0,"count":3}],"buffers":[{"byteLength":36,"uri":")";

struct Referrer
{
    const char* format;
    std::function<std::string(const std::string& name)> text; // a scene that refers to that name
};

const std::vector<Referrer>& referrers()
{
    static const std::vector<Referrer> all = {
        {"pbrt", [](const std::string& name) { return "WorldBegin\nInclude \"" + name + "\"\nShape \"sphere\"\n"; }},
        {"pbrt",
         [](const std::string& name) {
             return "WorldBegin\nTexture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"" + name +
                    "\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\"\n";
         }},
        {"pbrt",
         [](const std::string& name) {
             return "WorldBegin\nShape \"sphere\"\nShape \"plymesh\" \"string filename\" \"" + name + "\"\n";
         }},
        {"pbrt",
         [](const std::string& name) {
             return "WorldBegin\nLightSource \"infinite\" \"string filename\" \"" + name + "\"\nShape \"sphere\"\n";
         }},
        {"pbrt",
         [](const std::string& name) {
             return "WorldBegin\nLightSource \"point\" \"spectrum I\" \"" + name + "\"\nShape \"sphere\"\n";
         }},
        {"obj",
         [](const std::string& name) {
             return "mtllib " + name + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
         }},
        {"mtl", [](const std::string& name) { return "newmtl red\nmap_Kd " + name + "\nnewmtl glass\n"; }},
        {"gltf", [](const std::string& name) { return gltf_start + name + "\"}]}"; }},
    };
    return all;
}

// Opens a scene that refers to `name`: what the Error says, if any, and the notes.
void open(const Referrer& referrer, const Nest& nest, const std::string& name, const LoadOptions& options,
          std::optional<std::string>& error, std::string& notes)
{
    const Format& format = *find_format(referrer.format);
    open_checked(format, nest, referrer.text(name), "refers to " + name);
    error.reset();
    notes.clear();
    try {
        for (const Note& note : load_scene(nest.folder() / format.main, options).notes) notes += note.text + "\n";
    } catch (const Error& e) {
        error = e.what();
    }
}

} // namespace

TEST(HostileReferences, to_what_is_no_file)
{
    for (const Referrer& referrer : referrers()) {
        const Format& format = *find_format(referrer.format);
        const Nest nest(format);
        fs::create_symlink("b.link", nest.folder() / "a.link");
        fs::create_symlink("a.link", nest.folder() / "b.link");
        fs::create_symlink(format.main, nest.folder() / "self.link");
        fs::create_directory(nest.folder() / "folder.ply");
        ASSERT_EQ(::mkfifo((nest.folder() / "pipe.ply").c_str(), 0600), 0);
        for (const std::string& name :
             {std::string("a.link"), std::string("self.link"), std::string("folder.ply"), std::string("pipe.ply"),
              std::string("/dev/zero"), std::string("/dev/stdin"), std::string("/proc/self/mem"),
              std::string("/proc/self/cwd/../../../../dev/zero"), std::string("."), std::string(".."),
              std::string(300, 'x'), std::string(5000, 'y'), format.main, format.file, std::string("nul\\0.png"),
              std::string("%00%ff.bin")}) {
            if (name == "." && std::string(referrer.format) == "mtl") continue; // "map_Kd ." is how some write "none"
            std::optional<std::string> error;
            std::string notes;
            open(referrer, nest, name, {}, error, notes);
            // It cannot have gone well without a word.
            const std::string said = error.value_or("") + notes;
            EXPECT_FALSE(said.empty()) << referrer.format << " refers to " << name;
        }
    }
}

TEST(HostileReferences, outside_and_in_the_sandbox)
{
    for (const Referrer& referrer : referrers()) {
        const Nest nest(*find_format(referrer.format));
        for (const std::string name : {"/etc/hostname", "../../../../../../../etc/hostname", "../snell-none.png"}) {
            LoadOptions options;
            std::optional<std::string> error;
            std::string notes;
            open(referrer, nest, name, options, error, notes);
            EXPECT_FALSE(notes.empty() && !error) << referrer.format << " " << name;
            options.sandbox = true;
            open(referrer, nest, name, options, error, notes);
            const std::string said = error.value_or("") + notes;
            EXPECT_NE(said.find("sandbox"), std::string::npos) << referrer.format << " " << name << ": " << said;
        }
    }
}

TEST(HostileReferences, to_a_network)
{
    for (const Referrer& referrer : referrers()) {
        const Nest nest(*find_format(referrer.format));
        for (const std::string name : {"http://127.0.0.1:9/a.png", "https://example.org/a.ply", "ftp://a/b"}) {
            std::optional<std::string> error;
            std::string notes;
            open(referrer, nest, name, {}, error, notes);
            const std::string said = error.value_or("") + notes;
            EXPECT_TRUE(said.find("fetched") != std::string::npos || said.find("is not there") != std::string::npos)
                << referrer.format << " " << name << ": " << said;
        }
    }
}

} // namespace snell::hostile
