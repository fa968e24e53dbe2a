#include "snell/bvh/refit.h"

#include "snell/bvh/child_order.h"
#include "snell/bvh/primitives.h"
#include "snell/bvh/refit_lanes.h"
#include "snell/core/error.h"
#include "snell/core/parallel.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace snell {
namespace {

using namespace lanes;

// Nodes that one thread takes at a time: what it knows of them stays in its nearest cache.
constexpr std::size_t chunk_size = 128;

// The boxes of a node's children, and what one weighs in the cost; those that are not there are empty.
template <class Node>
struct Children
{
    static constexpr uint size = std::max(Node::width, 4u);
    Corners box[size];
    alignas(16) float weight[size] = {};
};

// How far ahead of a block its triangles and their vertices are asked for, in blocks, and its lines before that.
constexpr std::size_t triangles_ahead = 12, vertices_ahead = 6, lines_ahead = 48;

// Runs ahead of a thread that goes from block to block, and asks for what it will need.
template <std::size_t ahead, class Ask>
class Scout
{
  public:
    Scout(const Line* lines, std::size_t end, Ask ask) : lines_(lines), end_(end), ask_(ask) {}

    // The thread has come to that block.
    HWY_INLINE void follow(std::size_t block)
    {
        if (at_ <= block) at_ = block, distance_ = 0;
        while (distance_ < ahead && at_ < end_) {
            at_ += block_at(lines_, at_).size();
            ++distance_;
            if (at_ < end_) ask_(block_at(lines_, at_));
        }
        if (distance_ > 0) --distance_; // the next block is one nearer
    }

  private:
    const Line* lines_;
    std::size_t end_, at_ = 0, distance_ = 0; // in blocks
    Ask ask_;
};

template <class Node>
class Refitter
{
  public:
    Refitter(const PackedScene& scene, WideTree<Node>& tree)
        : scene_(scene), tree_(tree), positions_(scene.positions),
          boxes_(std::make_unique_for_overwrite<Corners[]>(tree.nodes.size()))
    {
    }

    void run()
    {
        if (tree_.root == word_done) return;
        find_scale();
        double below = 0;
        Corners box;
        const bool is_leaf = tree_.root >> 30 != 0;
        if (is_leaf) {
            float weight = 0;
            box = refit_leaf(tree_.root, weight, [](std::size_t) {});
            below = static_cast<double>(weight);
        } else {
            below = refit_nodes();
            box = boxes_[tree_.root];
        }
        tree_.box = box.box();
        if (tree_.box.empty()) tree_.box = {};
        const double area = tree_.box.half_area() * static_cast<double>(scale_) * static_cast<double>(scale_);
        tree_.sah_cost = is_leaf ? below : double(wide_node_cost) + (area > 0 ? below / area : below);
    }

  private:
    const PackedScene& scene_;
    WideTree<Node>& tree_;
    const Positions positions_;
    std::unique_ptr<Corners[]> boxes_; // of nodes
    float scale_ = 1;                  // areas are in units in which the root was about as large as 1: none overflows

    void find_scale()
    {
        const float size = tree_.box.empty() ? 0.0f : max3(tree_.box.extent());
        if (size > 0.0f && std::isfinite(1.0f / size)) scale_ = 1.0f / size;
    }

    // weight: gets the cost of its blocks. seen(block): is called for each block of triangles.
    template <class Seen>
    HWY_INLINE Corners refit_leaf(ChildWord word, float& weight, const Seen& seen) const
    {
        std::size_t index = word & child_index_mask;
        Corners all;
        if (word >> 30 == uint(RefKind::triangle)) {
            for (bool more = true; more;) {
                seen(index);
                TriangleBlock& block = block_at(tree_.lines.data(), index);
                all.extend(refill(scene_.triangles, positions_, block));
                weight += wide_block_cost;
                more = block.more != 0;
                index += block.size();
            }
            return all;
        }
        SNELL_CHECK_EQ(word >> 30, uint(RefKind::sphere)); // instances' trees are built anew
        for (const uint id : tree_.spheres[index].id) {
            if (id == none) continue;
            all.extend(corners_of(sphere_box(scene_.spheres[id])));
        }
        weight += wide_block_cost;
        return all;
    }

    bool is_leaf(ChildWord word) const { return word >> 30 != 0 && word != tree_.no_child; }

    // Sum of weights times areas.
    HWY_INLINE double weigh(const Children<Node>& children) const
    {
        const Four d;
        const Vec scale = hn::Set(d, scale_);
        double cost = 0;
        for (uint half = 0; half < Children<Node>::size; half += 4) {
            const Corners* box = children.box + half;
            const Rows lower = transpose(box[0].lower, box[1].lower, box[2].lower, box[3].lower);
            const Rows upper = transpose(box[0].upper, box[1].upper, box[2].upper, box[3].upper);
            const Vec x = hn::Mul(hn::Sub(upper.x, lower.x), scale), y = hn::Mul(hn::Sub(upper.y, lower.y), scale);
            const Vec z = hn::Mul(hn::Sub(upper.z, lower.z), scale);
            const Vec area = hn::Add(hn::Mul(x, hn::Add(y, z)), hn::Mul(y, z));
            const Vec part = hn::Mul(area, hn::Load(d, children.weight + half));
            alignas(16) float parts[4];
            hn::Store(hn::IfThenElseZero(hn::Ge(x, hn::Zero(d)), part), d, parts); // not of empty boxes
            for (const float p : parts) cost += static_cast<double>(p);
        }
        return cost;
    }

    // For a node whose leaves are done: writes boxes and orders.
    HWY_INLINE double finish(std::size_t index, Children<Node>& children)
    {
        Node& node = tree_.nodes[index];
        Corners all;
        for (uint slot = 0; slot < Node::width; ++slot) {
            const ChildWord word = node.child[slot];
            if (word >> 30 == 0) {
                children.box[slot] = boxes_[word];
                children.weight[slot] = wide_node_cost;
            }
            all.extend(children.box[slot]);
        }
        boxes_[index] = all;
        if constexpr (std::is_same_v<Node, Node8>) {
            const Four d;
            for (uint half = 0; half < 8; half += 4) {
                const Corners* box = children.box + half;
                const Rows lower = transpose(box[0].lower, box[1].lower, box[2].lower, box[3].lower);
                const Rows upper = transpose(box[0].upper, box[1].upper, box[2].upper, box[3].upper);
                hn::Store(lower.x, d, node.planes[0] + half);
                hn::Store(upper.x, d, node.planes[1] + half);
                hn::Store(lower.y, d, node.planes[2] + half);
                hn::Store(upper.y, d, node.planes[3] + half);
                hn::Store(lower.z, d, node.planes[4] + half);
                hn::Store(upper.z, d, node.planes[5] + half);
            }
            order_children(node);
        } else {
            Box boxes[Node::width];
            for (uint slot = 0; slot < Node::width; ++slot) boxes[slot] = children.box[slot].box();
            node.set_boxes(boxes);
        }
        return weigh(children);
    }

    // Returns the sum of weights times areas of all that is below the root. Leaves are taken in their order in memory;
    // then nodes from the last to the first, for children come after their parents. A chunk leaves alone what has
    // descendants in others, which is little more than the way from the root to it. That follows at the end.
    double refit_nodes()
    {
        struct Chunk
        {
            double cost = 0;
            std::vector<std::size_t> late; // nodes, descending
        };
        const std::size_t count = tree_.nodes.size();
        std::vector<Chunk> chunks((count + chunk_size - 1) / chunk_size);
        parallel_for(chunks.size(), [&](std::size_t c) {
            const std::size_t begin = c * chunk_size, end = std::min(begin + chunk_size, count);
            std::array<Children<Node>, chunk_size> children;
            refit_leaves(begin, end, children.data());
            std::array<std::uint8_t, chunk_size> ready;
            double cost = 0;
            for (std::size_t i = end; i-- > begin;) {
                const auto is_late = [&](ChildWord word) {
                    return word >> 30 == 0 && (word >= end || ready[word - begin] == 0);
                };
                const Node& node = tree_.nodes[i];
                ready[i - begin] = std::none_of(node.child, node.child + Node::width, is_late) ? 1 : 0;
                if (ready[i - begin] != 0)
                    cost += finish(i, children[i - begin]);
                else
                    chunks[c].late.push_back(i);
            }
            chunks[c].cost = cost;
        });
        double cost = 0;
        for (std::size_t c = chunks.size(); c-- > 0;) {
            cost += chunks[c].cost;
            for (const std::size_t i : chunks[c].late) {
                Children<Node> children;
                refit_leaves(i, i + 1, &children);
                cost += finish(i, children);
            }
        }
        return cost;
    }

    void refit_leaves(std::size_t begin, std::size_t end, Children<Node>* children) const
    {
        const auto ask_triangles = [&](const TriangleBlock& block) {
            for (const uint id : block.id) __builtin_prefetch(&scene_.triangles[id]);
            const char* const later = reinterpret_cast<const char*>(&block) + lines_ahead * sizeof(Line);
            for (uint i = 0; i < block.size(); ++i) __builtin_prefetch(later + i * sizeof(Line), 1);
        };
        const auto ask_vertices = [&](const TriangleBlock& block) {
            for (const uint id : block.id) __builtin_prefetch(&scene_.positions[scene_.triangles[id].v0]);
        };
        const std::size_t last = tree_.no_child & child_index_mask;
        Scout<triangles_ahead, decltype(ask_triangles)> triangles(tree_.lines.data(), last, ask_triangles);
        Scout<vertices_ahead, decltype(ask_vertices)> vertices(tree_.lines.data(), last, ask_vertices);
        const auto seen = [&](std::size_t block) {
            triangles.follow(block);
            vertices.follow(block);
        };
        for (std::size_t i = begin; i < end; ++i)
            for (uint slot = 0; slot < Node::width; ++slot) {
                const ChildWord word = tree_.nodes[i].child[slot];
                Children<Node>& to = children[i - begin];
                if (is_leaf(word)) to.box[slot] = refit_leaf(word, to.weight[slot], seen);
            }
    }
};

} // namespace

template <class Node>
void refit(const PackedScene& scene, WideTree<Node>& tree)
{
    Refitter<Node>(scene, tree).run();
}

template void refit(const PackedScene&, WideTree<Node2>&);
template void refit(const PackedScene&, WideTree<Node4>&);
template void refit(const PackedScene&, WideTree<Node8>&);
template void refit(const PackedScene&, WideTree<QuantisedNode>&);

} // namespace snell
