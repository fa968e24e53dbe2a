#include "snell/vulkan/device_tree.h"

#include "snell/core/error.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace snell {

// Scratch memory of up to so many primitives is kept for the next build: that of trees over instances, mostly.
constexpr std::size_t kept_primitives = std::size_t{1} << 18;

// Trees over more primitives are built by several submissions: none may take seconds even on a slow GPU, whose driver
// would take it for hanging.
constexpr std::size_t primitives_at_once = std::size_t{1} << 20;
constexpr uint rounds_at_once = 4;

// Behind the last block: what rays find in the place of children that are not there.
constexpr std::size_t spare_lines = 4;

constexpr auto on_device = GpuBuffer::Placement::device;

std::size_t DeviceTree::bytes() const
{
    std::size_t sum = 0;
    for (const auto* memory : {&order_memory, &node_memory, &line_memory, &sphere_memory})
        if (*memory) sum += (*memory)->bytes;
    return sum;
}

template <class Node>
DeviceTree describe_host_tree(const WideTree<Node>& tree)
{
    DeviceTree described;
    described.on_device.lower = tree.box.lower;
    described.on_device.upper = tree.box.upper;
    described.on_device.root = tree.root;
    described.nodes = tree.nodes.size();
    described.leaves = tree.leaves;
    described.sah_cost = described.built_cost = tree.sah_cost;
    described.left_out = tree.left_out;
    described.no_child = tree.no_child;
    std::vector<uint> level(tree.nodes.size(), 0);
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) { // children come after their parents
        described.levels = std::max(described.levels, level[i] + 1);
        for (const ChildWord child : tree.nodes[i].child)
            if (child >> 30 == 0) level[child] = level[i] + 1;
    }
    std::vector<uint>& begin = described.level_begin;
    begin.assign(described.levels + 1, 0);
    for (const uint l : level) ++begin[l + 1];
    for (uint l = 0; l < described.levels; ++l) begin[l + 1] += begin[l];
    std::vector<uint> next = begin;
    described.order.resize(tree.nodes.size());
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) described.order[next[level[i]]++] = static_cast<uint>(i);
    return described;
}
template DeviceTree describe_host_tree(const WideTree<Node2>&);
template DeviceTree describe_host_tree(const WideTree<QuantisedNode>&);

// ---- memory ----

struct TreeBuilder::Scratch
{
    Scratch(const Gpu& gpu, std::size_t n)
        : count(n), boxes(gpu, n * sizeof(Aabb), on_device, "building trees"),
          codes_0(gpu, n * sizeof(uint), on_device, "building trees"),
          codes_1(gpu, n * sizeof(uint), on_device, "building trees"),
          places_0(gpu, n * sizeof(uint), on_device, "building trees"),
          places_1(gpu, n * sizeof(uint), on_device, "building trees"),
          sums(gpu, blocks_of(n) * digit_count * sizeof(uint), on_device, "building trees"),
          nodes(gpu, 2 * n * sizeof(BuildNode), on_device, "building trees"),
          costs(gpu, (n / group_size + 1) * sizeof(float), on_device, "building trees")
    {
        static_assert(sizeof(WidePlan) <= sizeof(Aabb));
    }
    static std::size_t blocks_of(std::size_t n) { return (n + block_items - 1) / block_items; }

    // What is done with lends its memory to what comes later.
    void describe(BuildJob& job) const
    {
        job.boxes.address = job.plans.address = boxes.address;
        job.codes_0.address = job.wanted.address = codes_0.address;
        job.codes_1.address = job.clusters_0.address = codes_1.address;
        job.places_0.address = places_0.address;
        job.places_1.address = job.clusters_1.address = places_1.address;
        job.sums.address = sums.address;
        job.nodes.address = nodes.address;
        job.costs.address = costs.address;
    }

    const std::size_t count;
    const GpuBuffer boxes, codes_0, codes_1, places_0, places_1, sums, nodes, costs;
};

static BuildJob job_over(const TreeBuilder::Input& input)
{
    BuildJob job{};
    job.positions = input.scene.positions;
    job.triangles = input.scene.triangles;
    job.spheres = input.scene.spheres;
    job.instances = input.scene.instances;
    job.groups.address = input.groups;
    job.first_triangle = input.group.first_triangle;
    job.triangle_count = input.group.triangle_count;
    job.first_sphere = input.group.first_sphere;
    job.sphere_count = input.group.sphere_count;
    job.instance_count = input.instance_count;
    job.has_world = input.world != nullptr ? 1 : 0;
    job.count = input.instance_count > 0 ? input.instance_count + job.has_world
                                         : input.group.triangle_count + input.group.sphere_count;
    job.cost_below = static_cast<float>(input.cost_below);
    if (input.world != nullptr) job.tree = *input.world;
    return job;
}

static BuildCounters fresh_counters(uint count)
{
    BuildCounters counters{};
    counters.clusters[0] = counters.nodes[0] = count;
    for (uint axis = 0; axis < 3; ++axis) counters.low[axis] = ~0u;
    for (uint i = 1; i < 3; ++i) counters.cluster_groups[i] = counters.block_groups[i] = counters.level_groups[i] = 1;
    counters.root = word_done;
    return counters;
}

static float float_of_order(uint order)
{
    return std::bit_cast<float>((order & 0x80000000u) != 0u ? order & 0x7fffffffu : ~order);
}

static Box box_of(const BuildCounters& counters)
{
    Box box;
    if (counters.low[0] == ~0u) return box;
    for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = float_of_order(counters.low[axis]);
        box.upper[axis] = float_of_order(counters.high[axis]);
    }
    return box;
}

// ---- commands ----

TreeBuilder::TreeBuilder(std::shared_ptr<Gpu> gpu, std::uint32_t layout)
    : gpu_(std::move(gpu)), layout_(layout), commands_(*gpu_)
{
}

TreeBuilder::~TreeBuilder() = default;

void TreeBuilder::put(const GpuBuffer& to, std::size_t offset, const void* data, std::size_t bytes)
{
    vkCmdUpdateBuffer(commands_.handle, to.handle, offset, bytes, data);
}

void TreeBuilder::dispatch(const char* kernel, const BuildPush& push, std::size_t items)
{
    commands_.bind(gpu_->kernel(kernel, {layout_}));
    commands_.push(&push, sizeof(push));
    const auto groups = static_cast<std::uint32_t>((items + group_size - 1) / group_size);
    vkCmdDispatch(commands_.handle, std::min(groups, wide_dispatch), (groups + wide_dispatch - 1) / wide_dispatch, 1);
    commands_.barrier();
}

void TreeBuilder::dispatch_indirect(const char* kernel, const BuildPush& push, std::size_t offset)
{
    commands_.bind(gpu_->kernel(kernel, {layout_}));
    commands_.push(&push, sizeof(push));
    commands_.dispatch_indirect(*counters_, offset);
    commands_.barrier();
}

// A place where a long row of commands may be parted.
void TreeBuilder::part(std::size_t count)
{
    if (count <= primitives_at_once) return;
    commands_.run();
    commands_.begin();
}

void TreeBuilder::run_and_read_counters(std::size_t count)
{
    const VkBufferCopy copy{0, 0, count * sizeof(BuildCounters)};
    vkCmdCopyBuffer(commands_.handle, counters_->handle, counters_seen_->handle, 1, &copy);
    commands_.run();
    seen_.resize(count);
    std::memcpy(seen_.data(), counters_seen_->data, count * sizeof(BuildCounters));
}

void TreeBuilder::reserve_jobs(std::size_t count)
{
    if (jobs_ && jobs_->bytes >= count * sizeof(BuildJob)) return;
    jobs_.reset();
    counters_.reset();
    counters_seen_.reset();
    jobs_ = std::make_unique<GpuBuffer>(*gpu_, count * sizeof(BuildJob), on_device, "building trees");
    counters_ = std::make_unique<GpuBuffer>(*gpu_, count * sizeof(BuildCounters), on_device, "building trees");
    counters_seen_ = std::make_unique<GpuBuffer>(*gpu_, count * sizeof(BuildCounters), GpuBuffer::Placement::readback,
                                                 "building trees");
}

// ---- building ----

void TreeBuilder::build(DeviceTree& tree, const Input& input)
{
    BuildJob job = job_over(input);
    if (job.count == 0) {
        tree = {};
        return;
    }
    const std::size_t count = job.count;
    if (!scratch_ || scratch_->count < count) {
        scratch_.reset();
        scratch_ = std::make_unique<Scratch>(*gpu_, count);
    }
    reserve_jobs(1);
    scratch_->describe(job);
    job.counters.address = counters_->address;
    const BuildCounters counters = fresh_counters(job.count);
    BuildPush push{};
    push.job.address = jobs_->address;

    commands_.begin();
    put(*jobs_, 0, &job, sizeof(job));
    put(*counters_, 0, &counters, sizeof(counters));
    commands_.barrier();
    dispatch("build_boxes", push, count);
    dispatch("build_codes", push, count);
    record_sort(push, count);
    dispatch("build_leaves", push, count);
    record_joins(push, count);
    dispatch("collapse_first", push, 1);
    std::vector<uint> level_begin = make_levels(push);
    emit(tree, job, std::move(level_begin));
    if (scratch_->count > kept_primitives) scratch_.reset();
}

void TreeBuilder::record_sort(const BuildPush& job, std::size_t count)
{
    const std::size_t blocks = Scratch::blocks_of(count);
    BuildPush push = job;
    static_assert((key_bits + digit_bits - 1) / digit_bits % 2 == 0); // sorted keys are where they began
    for (push.round = 0; push.round * digit_bits < key_bits; ++push.round) {
        push.count = static_cast<uint>(blocks);
        dispatch("radix_count", push, blocks * group_size);
        push.count = static_cast<uint>(blocks * digit_count);
        dispatch("scan_words", push, 1);
        push.count = static_cast<uint>(blocks);
        dispatch("radix_place", push, blocks * group_size);
        part(count);
    }
}

// As many rounds as are usually enough, which make two fifths of a round's clusters one, and then as many as always
// are, in each of which every cluster finds another. Rounds for which nothing is left cost next to nothing.
void TreeBuilder::record_joins(const BuildPush& job, std::size_t count)
{
    const auto halvings = static_cast<uint>(std::bit_width(count - 1));
    const uint free_rounds = count > 1 ? 2 * halvings + 4 : 0, rounds = free_rounds + halvings;
    BuildPush push = job;
    for (push.round = 0; push.round < rounds; ++push.round) {
        push.which = push.round < free_rounds ? 0 : 1;
        dispatch("join_next", push, 1);
        dispatch_indirect("join_wanted", push, offsetof(BuildCounters, cluster_groups));
        dispatch_indirect("join_count", push, offsetof(BuildCounters, block_groups));
        dispatch("join_scan", push, 1);
        dispatch_indirect("join_merge", push, offsetof(BuildCounters, block_groups));
        if (push.round % rounds_at_once == 0) part(count);
    }
}

// Collapses level by level, and runs what was recorded. Returns where the levels begin, and their end.
std::vector<uint> TreeBuilder::make_levels(const BuildPush& job)
{
    std::vector<uint> begin(1, 0);
    for (;;) {
        BuildPush push = job;
        for (push.round = 0; push.round < levels_at_once; ++push.round) {
            dispatch_indirect("collapse", push, offsetof(BuildCounters, level_groups));
            dispatch("collapse_next", push, 1);
        }
        run_and_read_counters();
        const BuildCounters& c = seen_[0];
        for (uint level = 0; level <= levels_at_once; ++level) {
            if (c.level_begin[level + 1] == c.level_begin[level]) return begin;
            if (level < levels_at_once) begin.push_back(c.level_begin[level + 1]);
        }
        BuildCounters next = c;
        next.level_begin[0] = c.level_begin[levels_at_once];
        next.level_begin[1] = c.level_begin[levels_at_once + 1];
        commands_.begin();
        put(*counters_, 0, &next, sizeof(next));
        commands_.barrier();
    }
}

void TreeBuilder::emit(DeviceTree& tree, BuildJob job, std::vector<uint> level_begin)
{
    const BuildCounters& c = seen_[0];
    DeviceTree fresh;
    fresh.nodes = c.wide;
    fresh.leaves = c.leaves;
    fresh.levels = static_cast<uint>(level_begin.size() - 1);
    fresh.level_begin = std::move(level_begin);
    fresh.no_child = make_child(uint(RefKind::triangle), c.lines);
    fresh.node_memory = std::make_unique<GpuBuffer>(
        *gpu_, c.wide * (layout_ == layout_quantised ? sizeof(QuantisedNode) : sizeof(Node2)), on_device, "trees");
    fresh.line_memory = std::make_unique<GpuBuffer>(*gpu_, (c.lines + spare_lines) * sizeof(Line), on_device, "trees");
    fresh.sphere_memory = std::make_unique<GpuBuffer>(*gpu_, c.spheres * sizeof(SphereBlock), on_device, "trees");
    const Box box = box_of(c);
    fresh.on_device.lower = box.lower;
    fresh.on_device.upper = box.upper;
    fresh.on_device.root = c.root;
    fresh.on_device.nodes.address = job.out_nodes.address = fresh.node_memory->address;
    fresh.on_device.lines.address = job.out_lines.address = fresh.line_memory->address;
    fresh.on_device.spheres.address = job.out_spheres.address = fresh.sphere_memory->address;
    job.no_child = fresh.no_child;

    if (c.root != word_done) {
        BuildPush push{};
        push.job.address = jobs_->address;
        push.count = c.wide;
        commands_.begin();
        put(*jobs_, 0, &job, sizeof(job));
        vkCmdFillBuffer(commands_.handle, fresh.line_memory->handle, c.lines * sizeof(Line), spare_lines * sizeof(Line),
                        0);
        commands_.barrier();
        const TriangleBlock nothing{{}, 0, 12, 0, 0, {}};
        put(*fresh.line_memory, c.lines * sizeof(Line), &nothing, sizeof(nothing));
        dispatch("emit", push, std::max<std::size_t>(c.wide, 1));
        push.which = c.wide == 0 ? 1 : 0;
        push.count = std::max((c.wide + group_size - 1) / group_size, 1u);
        dispatch("tree_cost", push, 1);
        run_and_read_counters();
        fresh.sah_cost = fresh.built_cost = static_cast<double>(seen_[0].cost);
    }
    tree = std::move(fresh);
}

// ---- refitting ----

void TreeBuilder::refit(std::span<DeviceTree* const> trees, std::span<const Input> inputs)
{
    SNELL_CHECK_EQ(trees.size(), inputs.size());
    if (trees.empty()) return;
    std::size_t nodes = 0, groups = 0;
    for (const DeviceTree* tree : trees) {
        nodes += tree->nodes;
        groups += groups_of(*tree);
    }
    const GpuBuffer boxes(*gpu_, nodes * sizeof(Aabb), on_device, "refitting trees"),
        costs(*gpu_, groups * sizeof(float), on_device, "refitting trees");
    reserve_jobs(trees.size());
    commands_.begin();
    std::vector<BuildPush> pushes(trees.size());
    nodes = groups = 0;
    for (std::size_t i = 0; i < trees.size(); ++i) {
        DeviceTree& tree = *trees[i];
        if (!tree.order.empty() && !tree.order_memory) {
            const std::size_t bytes = tree.order.size() * sizeof(uint);
            tree.order_memory = std::make_unique<GpuBuffer>(*gpu_, bytes, on_device, "refitting trees");
            gpu_->upload(*tree.order_memory, 0, tree.order.data(), bytes);
        }
        BuildJob job = job_over(inputs[i]);
        job.tree = tree.on_device;
        job.out_nodes = tree.on_device.nodes;
        job.out_lines = tree.on_device.lines;
        job.out_spheres = tree.on_device.spheres;
        job.no_child = tree.no_child;
        job.order.address = tree.order_memory ? tree.order_memory->address : 0;
        job.boxes.address = boxes.address + nodes * sizeof(Aabb);
        job.costs.address = costs.address + groups * sizeof(float);
        job.counters.address = counters_->address + i * sizeof(BuildCounters);
        const BuildCounters counters = fresh_counters(0);
        put(*jobs_, i * sizeof(job), &job, sizeof(job));
        put(*counters_, i * sizeof(counters), &counters, sizeof(counters));
        pushes[i].job.address = jobs_->address + i * sizeof(job);
        nodes += tree.nodes;
        groups += groups_of(tree);
    }
    commands_.barrier();
    for (std::size_t i = 0; i < trees.size(); ++i) record_refit(*trees[i], pushes[i]);
    run_and_read_counters(trees.size());
    for (std::size_t i = 0; i < trees.size(); ++i) {
        const Box box = box_of(seen_[i]);
        trees[i]->on_device.lower = box.lower;
        trees[i]->on_device.upper = box.upper;
        trees[i]->sah_cost = static_cast<double>(seen_[i].cost);
    }
}

// Workgroups that leave a cost each.
std::size_t TreeBuilder::groups_of(const DeviceTree& tree)
{
    std::size_t groups = 1; // of a tree that is one leaf
    for (uint level = 0; level < tree.levels; ++level)
        groups += (tree.level_begin[level + 1] - tree.level_begin[level] + group_size - 1) / group_size;
    return groups;
}

void TreeBuilder::record_refit(const DeviceTree& tree, BuildPush push)
{
    uint groups = 0;
    for (uint level = tree.levels; level-- > 0;) {
        push.first = tree.level_begin[level];
        push.count = tree.level_begin[level + 1] - push.first;
        push.which = tree.order_memory ? 0 : 1;
        push.to = groups;
        dispatch("refit", push, push.count);
        groups += (push.count + group_size - 1) / group_size;
    }
    push.which = 2;
    push.count = 1;
    dispatch("refit", push, 1);
    push.which = tree.levels == 0 ? 1 : 0;
    push.count = std::max(groups, 1u);
    push.to = 1;
    dispatch("tree_cost", push, 1);
}

} // namespace snell
