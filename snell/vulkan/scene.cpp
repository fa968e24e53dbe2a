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

static_assert(sizeof(Node2) == 64 && offsetof(Node2, child) == 48 && offsetof(Node2, orders) == 56);
static_assert(offsetof(QuantisedNode, planes) == 24 && offsetof(QuantisedNode, child) == 72 &&
              offsetof(QuantisedNode, orders) == 104);
static_assert(sizeof(SphereBlock) == 32 && offsetof(TriangleBlock, id) == 16);

// Calls f with the trees that the accel has.
template <class F>
static void visit_trees(const Accel& accel, const F& f)
{
    if (const auto* quantised = find_wide_trees<QuantisedNode>(accel)) return f(*quantised);
    if (const auto* binary = find_wide_trees<Node2>(accel)) return f(*binary);
    fail_check(__FILE__, __LINE__, "trees that no GPU traces");
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

VulkanScene::VulkanScene(std::shared_ptr<Gpu> gpu, const PackedScene& scene, const AccelInfo& layout,
                         const AccelOptions& options, const Accel* built)
    : gpu_(std::move(gpu)), scene_(scene), options_(options),
      layout_(layout.name == "bvh2" ? layout_binary : layout_quantised),
      triangle_test_(options.triangle_test == TriangleTest::watertight ? test_watertight : test_moller_trumbore),
      arrays_(gpu_), host_trees_(gpu_), groups_(gpu_), builder_(gpu_, layout_)
{
    const Timer timer;
    upload_arrays();
    trees_.resize(scene_.groups.size() + 1);
    if (built != nullptr) {
        copy_trees(*built);
    } else {
        for (std::size_t i = 0; i < trees_.size(); ++i) builder_.build(trees_[i], input_for(i));
        upload_groups();
        build_top();
    }
    settle();
    tree_stats.build_seconds = upload_seconds = timer.seconds();
}

void VulkanScene::update(const PackedChanges& changes)
{
    const Timer timer;
    upload_arrays();
    upload_seconds = timer.seconds();
    tree_stats.refitted = tree_stats.rebuilt = 0;
    if (changes.any()) {
        follow_trees(changes);
        upload_groups();
        build_top();
    }
    settle();
    tree_stats.build_seconds = timer.seconds();
}

void VulkanScene::upload_arrays()
{
    view_ = scene_.view();
    std::vector<DeviceArrays::Item> items;
    for_each_array(scene_, view_, [&](const auto& array, const auto&) { items.push_back(item_of(array)); });
    uploaded_bytes = arrays_.follow(items);
    std::size_t item = 0;
    for_each_array(scene_, view_, [&](const auto&, auto& array) {
        const VkDeviceAddress address = arrays_.address(item++);
        std::memcpy(&array.at, &address, sizeof(address)); // no pointer of the host's
    });
    features_ = features_of(scene_);
}

void VulkanScene::copy_trees(const Accel& built)
{
    visit_trees(built, [&](const auto& input) {
        const auto& bvh = *input.bvh;
        std::vector<DeviceArrays::Item> items;
        for (const auto& group : bvh.groups) add_tree(items, group);
        add_tree(items, bvh.world);
        add_tree(items, bvh.top);
        uploaded_bytes += host_trees_.follow(items);
        std::size_t item = 0;
        const auto describe = [&](const auto& tree) {
            DeviceTree described = describe_host_tree(tree);
            GpuTree& on_device = described.on_device;
            for (WordBuffer* part : {&on_device.nodes, &on_device.lines, &on_device.spheres})
                part->address = host_trees_.address(item++);
            return described;
        };
        for (std::size_t i = 0; i < bvh.groups.size(); ++i) trees_[i] = describe(bvh.groups[i]);
        world() = describe(bvh.world);
        top_ = describe(bvh.top);
    });
    upload_groups();
}

TreeBuilder::Input VulkanScene::input_for(std::size_t tree) const
{
    TreeBuilder::Input input;
    input.scene = view_;
    input.group = tree < scene_.groups.size() ? scene_.groups[tree] : scene_.world;
    return input;
}

// What has changed its shape is refitted or built anew, by the options; see AccelOptions.
void VulkanScene::follow_trees(const PackedChanges& changes)
{
    std::vector<std::size_t> changed(changes.groups.begin(), changes.groups.end());
    if (changes.world) changed.push_back(scene_.groups.size());
    std::vector<DeviceTree*> trees;
    std::vector<TreeBuilder::Input> inputs;
    const auto can_follow = [&](const DeviceTree& tree) {
        // What was not finite when the tree was built has no place in it.
        return options_.update != UpdatePolicy::rebuild && tree.on_device.root != word_done && tree.left_out == 0;
    };
    for (const std::size_t i : changed) {
        if (!can_follow(trees_[i])) continue;
        trees.push_back(&trees_[i]);
        inputs.push_back(input_for(i));
    }
    builder_.refit(trees, inputs);
    for (const std::size_t i : changed) {
        DeviceTree& tree = trees_[i];
        const bool is_good =
            can_follow(tree) && !is_empty({tree.on_device.lower, tree.on_device.upper}) &&
            (options_.update == UpdatePolicy::refit || tree.sah_cost <= options_.rebuild_factor * tree.built_cost);
        if (!is_good) builder_.build(tree, input_for(i));
        ++(is_good ? tree_stats.refitted : tree_stats.rebuilt);
    }
}

void VulkanScene::upload_groups()
{
    std::vector<GpuTree> groups;
    for (std::size_t i = 0; i < scene_.groups.size(); ++i) groups.push_back(trees_[i].on_device);
    uploaded_bytes += groups_.follow({item_of(groups)});
}

void VulkanScene::build_top()
{
    TreeBuilder::Input input;
    input.scene = view_;
    input.instance_count = static_cast<uint>(scene_.instances.size());
    if (input.instance_count == 0) return;
    input.groups = groups_.address(0);
    if (world().on_device.root != word_done) input.world = &world().on_device;
    for (std::size_t i = 0; i < scene_.groups.size(); ++i) input.cost_below += trees_[i].sah_cost;
    input.cost_below /= static_cast<double>(scene_.groups.size());
    builder_.build(top_, input);
}

// What follows from the trees.
void VulkanScene::settle()
{
    uint below = 0;
    tree_stats.nodes = top_.nodes;
    tree_stats.leaves = top_.leaves;
    for (const DeviceTree& tree : trees_) {
        below = std::max(below, tree.levels);
        tree_stats.nodes += tree.nodes;
        tree_stats.leaves += tree.leaves;
    }
    tree_stats.sah_cost = (has_instances() ? top_ : world()).sah_cost;
    tree_stats.bytes = bytes() - arrays_.bytes();
    // Entries of the stack that a ray can ask for: one for each level of inner nodes.
    const uint levels = below + (has_instances() ? top_.levels + 1 : 0);
    if (levels > 4096)
        throw Error(fmt::format("the acceleration structure has {} levels: too many for a GPU", levels),
                    "try -D builder=binned, or --device cpu");
    stack_size_ = std::bit_ceil(std::max(levels, 32u)); // few sizes, few kernels
}

std::size_t VulkanScene::bytes() const
{
    std::size_t sum = arrays_.bytes() + host_trees_.bytes() + groups_.bytes() + top_.bytes();
    for (const DeviceTree& tree : trees_) sum += tree.bytes();
    return sum;
}

std::vector<std::uint32_t> VulkanScene::trace_constants(bool counts_steps) const
{
    return {features_, layout_, triangle_test_, stack_size_, scene_.coverage, counts_steps ? 1u : 0u};
}

void VulkanScene::describe(GpuJob& job) const
{
    job.scene = view_;
    job.groups.address = groups_.address(0);
    job.world = world().on_device;
    job.first = (has_instances() ? top_ : world()).on_device;
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

std::unique_ptr<DeviceScene> make_device_scene(const std::string& device, const PackedScene& scene,
                                               const AccelInfo& layout, const AccelOptions& options, const Accel* built)
{
    return std::make_unique<VulkanScene>(Gpu::open(device), scene, layout, options, built);
}

} // namespace snell
