// Trees that the device builds and refits itself.
#include "snell/bvh/refit.h"
#include "snell/bvh/simd/traverse.h"
#include "snell/bvh/wide_accel.h"
#include "snell/vulkan/trace_rays.h"
#include "tests/bvh/scenes.h"
#include "tests/render/scenes.h"
#include "tests/scene/moving_scene.h"
#include "tests/vulkan/gpu_test.h"

#include <cstring>
#include <map>

namespace snell::test {
namespace {

std::vector<std::byte> read_back(Gpu& gpu, const GpuBuffer& from, std::size_t bytes)
{
    const GpuBuffer seen(gpu, bytes, GpuBuffer::Placement::readback, "reading");
    Gpu::Commands commands(gpu);
    commands.begin();
    const VkBufferCopy copy{0, 0, bytes};
    vkCmdCopyBuffer(commands.handle, from.handle, seen.handle, 1, &copy);
    commands.run();
    const auto* data = static_cast<const std::byte*>(seen.data);
    return {data, data + bytes};
}

// An array of the host's and its copy on the device.
template <class T>
class Copied
{
  public:
    Copied(Gpu& gpu, const T* data, std::size_t count)
        : memory(gpu, count * sizeof(T), GpuBuffer::Placement::device, "testing"), gpu_(gpu), count_(count)
    {
        gpu.upload(memory, 0, data, count * sizeof(T));
    }
    void expect_bytes(const T* data, const char* what) const
    {
        if (count_ == 0) return;
        const std::vector<std::byte> found = read_back(gpu_, memory, count_ * sizeof(T));
        std::size_t wrong = 0;
        for (std::size_t i = 0; i < count_; ++i)
            wrong += std::memcmp(found.data() + i * sizeof(T), data + i, sizeof(T)) != 0 ? 1 : 0;
        EXPECT_EQ(wrong, 0u) << "of " << count_ << " " << what;
    }

    const GpuBuffer memory;

  private:
    Gpu& gpu_;
    const std::size_t count_;
};

template <class Array>
void set_address(Array& array, VkDeviceAddress address)
{
    std::memcpy(&array.at, &address, sizeof(address));
}

// What lies in the world of a scene, for a builder.
struct Primitives
{
    Primitives(Gpu& gpu, const PackedScene& scene)
        : positions(gpu, scene.positions.data(), scene.positions.size()),
          triangles(gpu, scene.triangles.data(), scene.triangles.size()),
          balls(gpu, scene.spheres.data(), scene.spheres.size())
    {
        set_address(input.scene.positions, positions.memory.address);
        set_address(input.scene.triangles, triangles.memory.address);
        set_address(input.scene.spheres, balls.memory.address);
        input.group = scene.world;
    }

    const Copied<vec3> positions;
    const Copied<Triangle> triangles;
    const Copied<Sphere> balls;
    TreeBuilder::Input input;
};

// Refits the host's tree on the device and on the host, and compares every byte.
template <class Node>
void expect_same_refit(PackedScene& scene, std::uint32_t layout, const std::function<void()>& change)
{
    WideTree<Node> tree = make_group_tree<Node>(scene, scene.world, {});
    const std::shared_ptr<Gpu> gpu = Gpu::open(test_device());
    DeviceTree on_device = describe_host_tree(tree);
    const Copied nodes(*gpu, tree.nodes.data(), tree.nodes.size());
    const Copied lines(*gpu, tree.lines.data(), tree.lines.size());
    const Copied spheres(*gpu, tree.spheres.data(), tree.spheres.size());
    on_device.on_device.nodes.address = nodes.memory.address;
    on_device.on_device.lines.address = lines.memory.address;
    on_device.on_device.spheres.address = spheres.memory.address;
    std::size_t listed = 0;
    for (uint level = 0; level < on_device.levels; ++level)
        listed += on_device.level_begin[level + 1] - on_device.level_begin[level];
    EXPECT_EQ(listed, tree.nodes.size());

    change();
    const Primitives primitives(*gpu, scene);
    TreeBuilder builder(gpu, layout);
    DeviceTree* const trees[] = {&on_device};
    builder.refit(trees, {&primitives.input, 1});
    refit(scene, tree);

    if (rounds_exactly()) {
        nodes.expect_bytes(tree.nodes.data(), "nodes");
        lines.expect_bytes(tree.lines.data(), "lines of blocks");
        EXPECT_EQ(on_device.on_device.lower, tree.box.lower);
        EXPECT_EQ(on_device.on_device.upper, tree.box.upper);
    }
    if (std::isfinite(tree.sah_cost))
        EXPECT_NEAR(on_device.sah_cost, tree.sah_cost, 1e-4 * tree.sah_cost);
    else
        EXPECT_FALSE(std::isfinite(on_device.sah_cost));
}

void expect_same_refits(const std::function<void(PackedScene&)>& make, const std::function<void(PackedScene&)>& change)
{
    for (const bool wide : {true, false}) {
        SCOPED_TRACE(wide ? "bvh8q" : "bvh2");
        PackedScene scene;
        make(scene);
        end_world(scene);
        if (wide)
            expect_same_refit<QuantisedNode>(scene, layout_quantised, [&] { change(scene); });
        else
            expect_same_refit<Node2>(scene, layout_binary, [&] { change(scene); });
    }
}

// Unlike add_grid(): triangles share their vertices.
void add_sheet(PackedScene& scene, uint n)
{
    const auto first = static_cast<uint>(scene.positions.size());
    for (uint i = 0; i < (n + 1) * (n + 1); ++i) {
        const float x = static_cast<float>(i % (n + 1)) / static_cast<float>(n) - 0.5f;
        const float z = static_cast<float>(i / (n + 1)) / static_cast<float>(n) - 0.5f;
        scene.positions.push_back(vec3(2.0f * x, 0.3f * x * z, 2.0f * z));
    }
    for (uint row = 0; row < n; ++row)
        for (uint column = 0; column < n; ++column) {
            const uint at = first + row * (n + 1) + column;
            scene.triangles.push_back({at, at + 1, at + n + 2, 0});
            scene.triangles.push_back({at, at + n + 2, at + n + 1, 0});
        }
}

void make_mixed(PackedScene& scene)
{
    Random random(1);
    add_soup(scene, random, 3000, 0.1f);
    add_cloud(scene, random, 300, 0.05f);
    add_sheet(scene, 20);
}

void wave(PackedScene& scene)
{
    for (vec3& p : scene.positions) p += 0.1f * vec3(std::sin(5.0f * p.y), std::cos(7.0f * p.z), std::sin(3.0f * p.x));
    for (Sphere& ball : scene.spheres) ball.center.x += 0.2f * ball.center.y, ball.radius *= 1.5f;
}

TEST(GpuTrees, RefitsAreTheHostsToTheByte)
{
    SNELL_NEEDS_GPU();
    expect_same_refits(make_mixed, wave);
    expect_same_refits(make_mixed, [](PackedScene& scene) { // as a map that mirrors does it
        for (vec3& p : scene.positions) p.x = -p.x;
        for (Triangle& triangle : scene.triangles) std::swap(triangle.v1, triangle.v2);
    });
    expect_same_refits(make_mixed, [](PackedScene& scene) { // flat, with zeros of both signs
        for (std::size_t i = 0; i < scene.positions.size(); ++i) scene.positions[i].y = i % 2 == 0 ? 0.0f : -0.0f;
    });
    expect_same_refits(make_mixed, [](PackedScene& scene) {
        for (vec3& p : scene.positions) p = 1e30f * p;
        for (Sphere& ball : scene.spheres) ball.center *= 1e-30f;
    });
    expect_same_refits([](PackedScene& scene) { add_grid(scene, 1, 0.0f); }, wave); // a leaf
    expect_same_refits([](PackedScene& scene) { add_sphere(scene, vec3(1.0f), 2.0f); }, wave);
}

TEST(GpuTrees, WhatIsNotFiniteIsNotHitUntilItIs)
{
    SNELL_NEEDS_GPU();
    const auto break_some = [](PackedScene& scene) {
        for (std::size_t i = 0; i < scene.positions.size(); i += 7)
            scene.positions[i][static_cast<int>(i % 3)] = i % 2 == 0 ? std::nanf("") : infinity();
        scene.spheres[0].radius = infinity();
    };
    expect_same_refits(make_mixed, break_some);

    // A tree that the device has built while some things were not finite finds them later.
    PackedScene scene;
    make_mixed(scene);
    end_world(scene);
    const std::vector<vec3> whole = scene.positions;
    break_some(scene);
    scene.spheres[0].radius = 0.05f;
    AccelOptions options;
    options.update = UpdatePolicy::refit;
    const auto on_device = make_device_scene(test_device(), scene, *find_accel("bvh8q"), options, nullptr);
    scene.positions = whole;
    PackedChanges changes;
    changes.world = true;
    on_device->update(changes);
    EXPECT_EQ(on_device->tree_stats.refitted, 1u);
    Random random(3);
    const std::vector<Ray> rays = random_rays(random, 2000);
    std::vector<Hit> expected(rays.size());
    find_accel("brute")->make(scene, {})->intersect(rays, expected);
    RayBatch batch(dynamic_cast<VulkanScene&>(*on_device), rays);
    batch.intersect();
    const std::vector<Hit> hits = batch.hits();
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) wrong += hits[i].primitive != expected[i].primitive ? 1 : 0;
    if (rounds_exactly()) {
        EXPECT_EQ(wrong, 0u);
    }
}

// What the device has built over `scene`, read back.
struct Built
{
    DeviceTree tree;
    std::vector<QuantisedNode> nodes;
    std::vector<Line> lines;
    std::vector<SphereBlock> spheres;
};

template <class T>
std::vector<T> read_array(Gpu& gpu, const GpuBuffer& memory, std::size_t count)
{
    std::vector<T> array(count);
    if (count == 0) return array;
    const std::vector<std::byte> bytes = read_back(gpu, memory, count * sizeof(T));
    std::memcpy(static_cast<void*>(array.data()), bytes.data(), bytes.size());
    return array;
}

Built build_on_device(const PackedScene& scene)
{
    const std::shared_ptr<Gpu> gpu = Gpu::open(test_device());
    const Primitives primitives(*gpu, scene);
    TreeBuilder builder(gpu, layout_quantised);
    Built built;
    builder.build(built.tree, primitives.input);
    if (built.tree.on_device.root == word_done) return built;
    built.nodes = read_array<QuantisedNode>(*gpu, *built.tree.node_memory, built.tree.nodes);
    built.lines = read_array<Line>(*gpu, *built.tree.line_memory, built.tree.line_memory->bytes / sizeof(Line));
    built.spheres =
        read_array<SphereBlock>(*gpu, *built.tree.sphere_memory, built.tree.sphere_memory->bytes / sizeof(SphereBlock));
    return built;
}

// Every primitive is in one leaf, every node has one parent, which comes before it, on the level above; children's
// boxes lie in their parents', but for the rounding of the grid, which only makes boxes larger.
void expect_sound(const PackedScene& scene)
{
    const Built built = build_on_device(scene);
    std::map<std::pair<uint, uint>, int> found;
    std::vector<int> parents(built.nodes.size(), 0);
    std::size_t leaves = 0;
    const auto visit = [&](ChildWord word, std::size_t parent) {
        if (word == built.tree.no_child) return;
        const uint kind = word >> 30, index = word & child_index_mask;
        if (kind == 0) {
            ASSERT_LT(index, built.nodes.size());
            EXPECT_TRUE(index == 0 || index > parent);
            ++parents[index];
            return;
        }
        ++leaves;
        if (kind == uint(RefKind::triangle)) {
            const TriangleBlock& block = block_at(built.lines.data(), index);
            ASSERT_GT(block.count, 0);
            EXPECT_EQ(block.more, 0);
            for (uint lane = 0; lane < block.count; ++lane) {
                ++found[{kind, block.id[lane]}];
                const Triangle& tri = scene.triangles[block.id[lane]];
                const vec3 corners[] = {scene.positions[tri.v0], scene.positions[tri.v1], scene.positions[tri.v2]};
                for (uint v = 0; v < 3; ++v) {
                    const vec3 corner = block.vertex(lane, v);
                    EXPECT_EQ(std::memcmp(&corner, &corners[v], sizeof(vec3)), 0);
                }
            }
            return;
        }
        for (const uint id : built.spheres[index].id)
            if (id != none) ++found[{kind, id}];
    };
    visit(built.tree.on_device.root, 0);
    for (std::size_t i = 0; i < built.nodes.size(); ++i)
        for (const ChildWord word : built.nodes[i].child) visit(word, i);
    EXPECT_EQ(found.size(), scene.triangles.size() + scene.spheres.size());
    for (const auto& [primitive, times] : found) EXPECT_EQ(times, 1) << primitive.first << " " << primitive.second;
    for (const int times : parents) EXPECT_EQ(times, 1);
    EXPECT_EQ(leaves, built.tree.leaves);
    EXPECT_EQ(built.tree.level_begin.empty() ? 0 : built.tree.level_begin.back(), built.nodes.size());
}

TEST(GpuTrees, HoldEveryPrimitiveOnce)
{
    SNELL_NEEDS_GPU();
    PackedScene mixed;
    make_mixed(mixed);
    end_world(mixed);
    expect_sound(mixed);
    for (const int count : {1, 2, 4, 5, 9, 63, 64, 65, 1023, 1025, 2100}) {
        SCOPED_TRACE(count);
        Random random(static_cast<uint>(count));
        PackedScene scene;
        add_soup(scene, random, count, 0.2f);
        end_world(scene);
        expect_sound(scene);
        PackedScene balls;
        add_cloud(balls, random, count, 0.2f);
        end_world(balls);
        expect_sound(balls);
        PackedScene alike; // all in one place
        for (int i = 0; i < count; ++i) add_triangle(alike, vec3(0.0f), vec3(1.0f, 0.0f, 0.0f), vec3(0.0f, 1.0f, 0.0f));
        end_world(alike);
        expect_sound(alike);
        PackedScene row; // surfaces that grow along the curve
        for (int i = 0; i < count; ++i) {
            const float x = std::exp2(-0.02f * static_cast<float>(i));
            add_triangle(row, vec3(x, 0.0f, 0.0f), vec3(x, x, 0.0f), vec3(x, 0.0f, x));
        }
        end_world(row);
        expect_sound(row);
    }
    PackedScene nothing;
    end_world(nothing);
    EXPECT_EQ(build_on_device(nothing).tree.on_device.root, word_done);
    add_triangle(nothing, vec3(std::nanf("")), vec3(0.0f), vec3(1.0f));
    end_world(nothing);
    EXPECT_EQ(build_on_device(nothing).tree.on_device.root, word_done);
}

// A tree for which rays wait is no fast option.
TEST(GpuTrees, AreAboutAsGoodAsTheHostsOfTheSameKind)
{
    SNELL_NEEDS_GPU();
    for (const int scene_number : {0, 1, 2}) {
        SCOPED_TRACE(scene_number);
        Random random(5);
        PackedScene scene;
        if (scene_number == 0) add_soup(scene, random, 20000, 0.05f);
        if (scene_number == 1) add_grid(scene, 100, 0.3f);
        if (scene_number == 2) make_mixed(scene);
        end_world(scene);
        BuildOptions options;
        options.builder = "ploc";
        const double on_host = make_group_tree<QuantisedNode>(scene, scene.world, options).sah_cost;
        const double on_device = build_on_device(scene).tree.sah_cost;
        std::printf("cost on the device %.1f, on the host %.1f\n", on_device, on_host);
        EXPECT_LT(on_device, 1.6 * on_host);
        EXPECT_GT(on_device, 0.7 * on_host); // or it is not reckoned right
    }
}

// Whoever builds, refits and rebuilds: pictures are those of a scene that was prepared as it is then.
TEST(GpuTrees, PicturesFollowAScene)
{
    SNELL_NEEDS_GPU();
    for (const char* build_on : {"cpu", "gpu"})
        for (const char* update : {"refit", "rebuild"}) {
            SCOPED_TRACE(fmt::format("built on the {}, {}", build_on, update));
            RenderSettings settings;
            settings.width = 56;
            settings.height = 40;
            settings.spp = 1;
            settings.device = test_device();
            settings.keep_motion = true;
            settings.parameters["build_on"] = build_on;
            settings.parameters["update"] = update;
            Scene scene = moving_scene();
            const auto prepared = prepare(scene, settings);
            for (const float time : {0.3f, 0.9f}) {
                pose(scene, first_animation, time);
                prepared->update(scene, change_pose);
                EXPECT_TRUE(prepared->updated);
                const AccelStats& stats = prepared->accel->stats;
                EXPECT_GE(std::string_view(update) == "refit" ? stats.refitted : stats.rebuilt, 1u);
                EXPECT_EQ(std::string_view(update) == "refit" ? stats.rebuilt : stats.refitted, 0u);
                EXPECT_LT(prepared->device->uploaded_bytes, prepared->device->bytes());
                const Film followed = render(*prepared, settings).film;
                RenderSettings fresh = settings;
                fresh.parameters.clear();
                EXPECT_TRUE(same_bits(followed.sum, render(scene, fresh).film.sum));

                // The host's own structure follows when it is asked.
                Random random(1);
                const std::vector<Ray> rays = random_rays(random, 500, 3.0f);
                std::vector<Hit> hits(rays.size()), expected(rays.size());
                prepared->accel->intersect(rays, hits);
                find_accel("brute")->make(prepared->packed, {})->intersect(rays, expected);
                EXPECT_EQ(std::memcmp(hits.data(), expected.data(), hits.size() * sizeof(Hit)), 0);
            }
        }
}

TEST(GpuTrees, AreBuiltOnTheProcessorWhereThatRenders)
{
    RenderSettings settings;
    settings.parameters["build_on"] = "gpu";
    try {
        prepare(mixed_scene(), settings);
        ADD_FAILURE() << "nobody has said that there is no GPU";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("--device gpu"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace snell::test
