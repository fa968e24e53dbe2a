#include "snell/vulkan/scene.h"

#include "snell/bvh/simd/traverse.h"
#include "snell/bvh/wide_accel.h"
#include "snell/core/error.h"
#include "snell/core/timer.h"
#include "snell/kernel/features.h"
#include "snell/kernel/intersect.h"
#include "snell/vulkan/queues.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace snell {

// ---- arrays ----

// As most devices like it; more than any type needs.
constexpr std::size_t array_alignment = 256;
// An array of the kernels may be read one vector beyond its end.
constexpr std::size_t array_margin = 64;

std::size_t DeviceArrays::follow(const std::vector<Item>& items)
{
    bool fits = items.size() == places_.size();
    for (std::size_t i = 0; fits && i < items.size(); ++i) fits = places_[i].bytes == items[i].bytes;
    if (!fits) place(items);
    std::size_t copied = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
        const Hash128 hash = hash_in_parallel(items[i].data, items[i].bytes);
        if (fits && hash == places_[i].hash) continue;
        places_[i].hash = hash;
        gpu_->upload(*buffers_[places_[i].buffer], places_[i].offset, items[i].data, items[i].bytes);
        copied += items[i].bytes;
    }
    return copied;
}

void DeviceArrays::place(const std::vector<Item>& items)
{
    places_.clear();
    buffers_.clear(); // not two of them at a time
    bytes_ = 0;
    const std::size_t most = gpu_->info().max_allocation;
    std::vector<std::size_t> sizes(1, 0); // of the buffers
    for (const Item& item : items) {
        const std::size_t room = (item.bytes + array_margin + array_alignment - 1) / array_alignment * array_alignment;
        if (sizes.back() > 0 && sizes.back() + room > most) sizes.push_back(0);
        places_.push_back({item.bytes, sizes.size() - 1, sizes.back(), 0, {}});
        sizes.back() += room;
    }
    for (const std::size_t size : sizes) {
        buffers_.push_back(std::make_unique<GpuBuffer>(*gpu_, size, GpuBuffer::Placement::device, "the scene"));
        bytes_ += size;
    }
    for (Place& place : places_) place.address = buffers_[place.buffer]->address + place.offset;
}

// ---- the scene ----

// Every array of a SceneView: f(array of the packed scene, array of the view). A new one belongs here, and nowhere else
// in this backend.
template <class F>
static void for_each_array(const PackedScene& scene, SceneView& view, const F& f)
{
    static_assert(sizeof(SceneView) == 256); // changed: is its new array in this list?
    f(scene.positions, view.positions);
    f(scene.normals, view.normals);
    f(scene.uvs, view.uvs);
    f(scene.tangents, view.tangents);
    f(scene.colors, view.colors);
    f(scene.triangles, view.triangles);
    f(scene.surfaces, view.surfaces);
    f(scene.spheres, view.spheres);
    f(scene.planes, view.planes);
    f(scene.instances, view.instances);
    f(scene.materials, view.materials);
    f(scene.lights, view.lights);
    f(scene.textures, view.textures);
    f(scene.texels, view.texels);
    f(scene.srgb, view.srgb);
    f(scene.slots, view.slots);
    f(scene.principled, view.principled);
    f(scene.albedo, view.albedo);
    f(scene.environment_cdf, view.environment_cdf);
}

template <class T>
static DeviceArrays::Item item_of(const std::vector<T>& array)
{
    return {array.data(), array.size() * sizeof(T)};
}

template <class T>
static DeviceArrays::Item item_of(const RawVector<T>& array)
{
    return {array.data(), array.size() * sizeof(T)};
}

template <class Node>
static void add_tree(std::vector<DeviceArrays::Item>& items, const WideTree<Node>& tree)
{
    items.push_back(item_of(tree.nodes));
    items.push_back(item_of(tree.lines));
    items.push_back(item_of(tree.spheres));
}

template <class Node>
static GpuTree describe_tree(const DeviceArrays& arrays, std::size_t& item, const WideTree<Node>& tree)
{
    GpuTree on_device{};
    on_device.nodes.address = arrays.address(item++);
    on_device.lines.address = arrays.address(item++);
    on_device.spheres.address = arrays.address(item++);
    on_device.lower = tree.box.lower;
    on_device.upper = tree.box.upper;
    on_device.root = tree.root;
    return on_device;
}

// Levels of inner nodes: entries of the stack that a ray in the tree can ask for.
template <class Node>
static std::uint32_t levels_of(const WideTree<Node>& tree)
{
    std::vector<std::uint32_t> level(tree.nodes.size(), 1);
    std::uint32_t most = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) { // children come after their parents
        most = std::max(most, level[i]);
        for (const ChildWord child : tree.nodes[i].child)
            if (child >> 30 == 0) level[child & child_index_mask] = level[i] + 1;
    }
    return most;
}

template <class Node>
static std::uint32_t levels_of(const WideBvh<Node>& bvh)
{
    std::uint32_t below = levels_of(bvh.world);
    for (const WideTree<Node>& group : bvh.groups) below = std::max(below, levels_of(group));
    return below + (bvh.has_instances() ? levels_of(bvh.top) + 1 : 0);
}

static_assert(sizeof(Node2) == 64 && offsetof(Node2, child) == 48 && offsetof(Node2, orders) == 56);
static_assert(offsetof(QuantisedNode, planes) == 24 && offsetof(QuantisedNode, child) == 72 &&
              offsetof(QuantisedNode, orders) == 104);
static_assert(sizeof(SphereBlock) == 32 && offsetof(TriangleBlock, id) == 16);

// Calls f with the trees that the accel has, and their number.
template <class F>
static void visit_trees(const Accel& accel, const F& f)
{
    if (const auto* quantised = find_wide_trees<QuantisedNode>(accel)) return f(*quantised, layout_quantised);
    if (const auto* binary = find_wide_trees<Node2>(accel)) return f(*binary, layout_binary);
    throw Error("GPUs trace the structures bvh8q and bvh2 only", "choose one of them by --accel, or leave it out");
}

static bool has_texture(const Principled& p)
{
    for (const uint slot :
         {p.metallic_slot, p.roughness_slot, p.specular_slot, p.specular_color_slot, p.clearcoat_slot,
          p.clearcoat_roughness_slot, p.clearcoat_normal_slot, p.sheen_color_slot, p.sheen_roughness_slot,
          p.transmission_slot, p.anisotropy_slot, p.iridescence_slot, p.iridescence_thickness_slot,
          p.diffuse_transmission_slot, p.diffuse_transmission_color_slot})
        if (slot != none) return true;
    return false;
}

// feature_* of a scene. What is missing in them is left out of the kernels.
static std::uint32_t features_of(const PackedScene& scene)
{
    std::uint32_t features = 0;
    const auto note = [&](std::uint32_t feature, bool there) { features |= there ? feature : 0u; };
    for (const Material& m : scene.materials) {
        features |= 1u << m.kind;
        note(feature_tangents, (m.flags & material_needs_tangents) != 0u);
        note(feature_textures,
             m.base_slot != none || m.emission_slot != none || m.normal_slot != none || m.opacity_slot != none);
    }
    for (const Principled& p : scene.principled) {
        note(feature_textures, has_texture(p));
        note(feature_clearcoat, p.clearcoat > 0.0f);
        note(feature_sheen, max3(p.sheen_color) > 0.0f);
        note(feature_glass, p.transmission > 0.0f);
        note(feature_iridescence, p.iridescence > 0.0f);
        note(feature_anisotropy, p.anisotropy != 0.0f);
        note(feature_dispersion, p.dispersion > 0.0f);
    }
    note(feature_environment_cells, scene.environment.columns > 0u);
    note(feature_environment_texture, scene.environment.texture != none);
    note(feature_spheres, !scene.spheres.empty());
    note(feature_planes, !scene.planes.empty());
    note(feature_instances, !scene.instances.empty());
    return features;
}

VulkanScene::VulkanScene(std::shared_ptr<Gpu> gpu, const PackedScene& scene, const Accel& accel)
    : gpu_(std::move(gpu)), scene_(scene), accel_(accel), arrays_(gpu_), groups_(gpu_)
{
    update();
}

void VulkanScene::update()
{
    const Timer timer;
    visit_trees(accel_, [&](const auto& input, std::uint32_t layout) {
        const auto& bvh = *input.bvh;
        view_ = scene_.view();
        std::vector<DeviceArrays::Item> items;
        for_each_array(scene_, view_, [&](const auto& array, const auto&) { items.push_back(item_of(array)); });
        add_tree(items, bvh.world);
        add_tree(items, bvh.top);
        for (const auto& group : bvh.groups) add_tree(items, group);
        uploaded_bytes = arrays_.follow(items);

        std::size_t item = 0;
        for_each_array(scene_, view_, [&](const auto&, auto& array) {
            const VkDeviceAddress address = arrays_.address(item++);
            std::memcpy(&array.at, &address, sizeof(address)); // no pointer of the host's
        });
        world_ = describe_tree(arrays_, item, bvh.world);
        first_ = describe_tree(arrays_, item, bvh.top);
        if (!bvh.has_instances()) first_ = world_;
        std::vector<GpuTree> groups;
        for (const auto& group : bvh.groups) groups.push_back(describe_tree(arrays_, item, group));
        uploaded_bytes += groups_.follow({item_of(groups)});

        layout_ = layout;
        features_ = features_of(scene_);
        triangle_test_ = input.triangle_test == TriangleTest::watertight ? test_watertight : test_moller_trumbore;
        const std::uint32_t levels = levels_of(bvh);
        if (levels > 4096)
            throw Error(fmt::format("the acceleration structure has {} levels: too many for a GPU", levels),
                        "try -D builder=binned, or --device cpu");
        stack_size_ = std::bit_ceil(std::max(levels, 32u)); // few sizes, few kernels
    });
    upload_seconds = timer.seconds();
}

std::vector<std::uint32_t> VulkanScene::trace_constants(bool counts_steps) const
{
    return {features_, layout_, triangle_test_, stack_size_, scene_.coverage, counts_steps ? 1u : 0u};
}

void VulkanScene::describe(GpuJob& job) const
{
    job.scene = view_;
    job.groups.address = groups_.address(0);
    job.world = world_;
    job.first = first_;
}

VulkanScene::~VulkanScene() = default;

std::unique_ptr<Queues> VulkanScene::take_queues(std::size_t capacity, QueueKinds kinds)
{
    {
        const std::lock_guard lock(queues_mutex_);
        for (auto free = free_queues_.begin(); free != free_queues_.end(); ++free) {
            if ((*free)->kinds != kinds || (*free)->capacity < capacity) continue;
            std::unique_ptr<Queues> taken = std::move(*free);
            free_queues_.erase(free);
            return taken;
        }
        free_queues_.clear(); // too small, or of other kinds: the memory is needed
    }
    return std::make_unique<Queues>(gpu_, capacity, kinds);
}

void VulkanScene::give_queues(std::unique_ptr<Queues> queues)
{
    const std::lock_guard lock(queues_mutex_);
    free_queues_.push_back(std::move(queues));
}

std::unique_ptr<DeviceScene> make_device_scene(const std::string& device, const PackedScene& scene, const Accel& accel)
{
    return std::make_unique<VulkanScene>(Gpu::open(device), scene, accel);
}

} // namespace snell
