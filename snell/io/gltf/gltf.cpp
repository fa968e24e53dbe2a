#include "snell/io/gltf/gltf.h"

#include "snell/core/text.h"
#include "snell/io/gltf/material.h"
#include "snell/io/gltf/nodes.h"

#include <chrono>
#include <mutex>
#include <new>

namespace fs = std::filesystem;

namespace snell {

namespace gltf {
namespace {

// Tells of the part that is done, a few times a second, whoever calls.
class Progress
{
  public:
    explicit Progress(const LoadProgressCallback& callback) : callback_(callback) {}

    // What follows is the part of the whole from `begin` to `end`.
    void begin(std::string what, double begin, double end)
    {
        const std::lock_guard lock(mutex_);
        what_ = std::move(what), begin_ = begin, end_ = end;
        tell(0.0);
    }
    void operator()(double part)
    {
        const std::lock_guard lock(mutex_);
        if (Clock::now() - time_ > std::chrono::milliseconds(250)) tell(part);
    }

  private:
    using Clock = std::chrono::steady_clock;
    void tell(double part)
    {
        time_ = Clock::now();
        if (callback_) callback_({what_, begin_ + (end_ - begin_) * part});
    }

    const LoadProgressCallback& callback_;
    std::mutex mutex_;
    std::string what_;
    double begin_ = 0.0, end_ = 1.0;
    Clock::time_point time_{};
};

// Which material a primitive has, given the variant that is asked for.
class MaterialChoice
{
  public:
    MaterialChoice(const Document& document, Scene& scene, const std::string& variant)
        : document_(document), scene_(scene)
    {
        const tinygltf::Value* const variants = Fields(document.model.extensions, extension).find("variants");
        for (std::size_t i = 0; variants && i < variants->ArrayLen(); ++i) {
            scene.variants.push_back(Fields(&variants->Get(static_cast<int>(i))).text("name"));
            if (!variant.empty() && scene.variants.back() == variant && chosen_ < 0) chosen_ = static_cast<int>(i);
        }
        if (variant.empty() || chosen_ >= 0) return;
        const std::string guess = nearest(variant, scene.variants);
        throw Error(fmt::format("there is no variant '{}'", variant),
                    scene.variants.empty() ? "the file offers none"
                    : guess.empty()
                        ? fmt::format("the file offers {}", fmt::join(scene.variants, ", "))
                        : fmt::format("did you mean '{}'? The file offers {}", guess, fmt::join(scene.variants, ", ")));
    }

    Index<MaterialDesc> operator()(std::size_t mesh, std::size_t primitive)
    {
        const tinygltf::Primitive& source = document_.model.meshes[mesh].primitives[primitive];
        int material = source.material;
        if (chosen_ >= 0) material = mapped(source, material);
        if (material < 0) {
            if (!default_.valid()) default_ = add(scene_, default_material());
            return default_;
        }
        checked(document_.model.materials, material, "material",
                label("mesh", mesh, document_.model.meshes[mesh].name) + fmt::format(", primitive {}", primitive));
        return {static_cast<uint>(material)};
    }

  private:
    static constexpr const char* extension = "KHR_materials_variants";

    int mapped(const tinygltf::Primitive& source, int otherwise) const
    {
        const tinygltf::Value* const mappings = Fields(source.extensions, extension).find("mappings");
        for (std::size_t i = 0; mappings && i < mappings->ArrayLen(); ++i) {
            const Fields mapping(&mappings->Get(static_cast<int>(i)));
            for (const double variant : mapping.numbers("variants"))
                if (variant == static_cast<double>(chosen_)) return mapping.integer("material", -1);
        }
        return otherwise;
    }

    const Document& document_;
    Scene& scene_;
    int chosen_ = -1;
    Index<MaterialDesc> default_;
};

// A picture without holes in its alpha need not be looked up for them.
void drop_full_opacity(Scene& scene, const Images& images)
{
    for (MaterialDesc& material : scene.materials)
        if (material.opacity_texture.valid() && images.is_opaque(material.opacity_texture.image))
            material.opacity_texture = TextureRef{};
}

void load(const fs::path& file, const LoadOptions& options, Scene& scene)
{
    Remarks remarks;
    Budget budget;
    Progress progress(options.progress);
    const std::string name = file.filename().string();

    progress.begin("reading " + name, 0.0, 0.1);
    Document document;
    read_document(document, file, remarks);
    check_extensions(document, remarks);
    References references(file, options.sandbox, scene);
    const Buffers buffers(document, references, budget);
    const Accessors accessors(document, buffers, budget);

    scene.name = file.stem().string();
    MaterialChoice choice(document, scene, options.variant);
    Images images(document, buffers, references, budget);
    for (std::size_t i = 0; i < document.model.materials.size(); ++i)
        add(scene, to_material(document, i, images, remarks));
    const Hierarchy hierarchy = read_nodes(document, scene, remarks);
    read_skins(document, accessors, scene);

    progress.begin("building the meshes of " + name, 0.1, 0.4);
    read_meshes(document, buffers, accessors, budget, hierarchy, std::ref(choice), std::ref(progress), scene, remarks);
    read_lights(document, hierarchy, scene, remarks);
    read_cameras(document, hierarchy, scene, remarks);
    read_animations(document, accessors, scene, remarks);

    progress.begin("decoding the textures of " + name, 0.4, 0.85);
    images.decode(scene, remarks, std::ref(progress));
    drop_full_opacity(scene, images);

    progress.begin("posing " + name, 0.85, 0.9);
    remarks.tell(scene, file.string());
    if (!scene.nodes.empty()) pose(scene, {}, 0.0f);
}

} // namespace
} // namespace gltf

Scene load_gltf(const fs::path& file, const LoadOptions& options)
{
    Scene scene;
    try {
        gltf::load(file, options, scene);
    } catch (const Error& error) {
        // Most of the reader knows parts of the file, but not its name.
        if (!error.place.file.empty()) throw;
        throw Error({file.string()}, error.what());
    } catch (const std::bad_alloc&) {
        throw Error({file.string()}, "the scene does not fit into memory", "load a smaller one");
    }
    return scene;
}

} // namespace snell
