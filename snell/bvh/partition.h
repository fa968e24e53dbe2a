// References that are parted by a predicate, from one array into another and back, by one thread or several.
#pragma once

#include "snell/bvh/extents.h"
#include "snell/bvh/scratch.h"
#include "snell/core/parallel.h"

#include <algorithm>
#include <span>
#include <vector>

namespace snell {

// A run of references, with the extents that choosing a split needs.
struct RefPart
{
    std::size_t begin = 0, end = 0;
    uint side = 0; // which of the two arrays they are in
    Extents extents;
};

class RefPartition
{
  public:
    explicit RefPartition(std::vector<PrimitiveRef> primitives)
        : primitives_(std::move(primitives)), scratch_(primitives_.size()), sides_{primitives_.data(), scratch_.data()}
    {
    }

    RefPart whole() const
    {
        RefPart part{0, primitives_.size(), 0, {}};
        std::vector<Extents> parts(chunks_of(part));
        for_chunks(part, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
            Extents e;
            for (const PrimitiveRef& ref : std::span(primitives_).subspan(begin, end - begin)) e.extend(ref);
            parts[chunk] = e;
        });
        for (const Extents& e : parts) part.extents.extend(e);
        return part;
    }

    static Box box(const RefPart& part) { return part.extents.box.box(); }

    std::span<const PrimitiveRef> range(const RefPart& part) const
    {
        return {sides_[part.side] + part.begin, part.end - part.begin};
    }

    BinaryTree::Entry entry(const RefPart& part, std::size_t position) const
    {
        const PrimitiveRef& ref = sides_[part.side][position];
        return {ref.index, ref.kind};
    }

    // Moves the references of the part into the other array, those that is_left() names to the front. The order within
    // a side changes, but not with the number of threads. A side may be empty.
    template <class IsLeft>
    void split(const RefPart& part, const IsLeft& is_left, RefPart& left, RefPart& right)
    {
        const PrimitiveRef* from = sides_[part.side];
        PrimitiveRef* to = sides_[1 - part.side];
        std::size_t middle;
        left.extents = right.extents = {};
        if (part.end - part.begin <= 2 * chunk_size) {
            middle = move(from + part.begin, from + part.end, is_left, to, part.begin, part.end, left.extents,
                          right.extents);
        } else {
            // Count first: then each chunk knows where its share belongs.
            std::vector<Share> shares(chunks_of(part));
            for_chunks(part, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                std::size_t count = 0;
                for (std::size_t i = begin; i < end; ++i) count += is_left(from[i]) ? 1 : 0;
                shares[chunk].left = count;
            });
            std::size_t at = part.begin;
            for (Share& share : shares) {
                const std::size_t count = share.left;
                share.left = at;
                at += count;
            }
            middle = at;
            for_chunks(part, [&](std::size_t chunk, std::size_t begin, std::size_t end) {
                // Those on the right before this chunk, and up to its end: all that are not on the left.
                Share& share = shares[chunk];
                const std::size_t next = chunk + 1 < shares.size() ? shares[chunk + 1].left : middle;
                const std::size_t right_end = middle + (end - part.begin) - (next - part.begin);
                Extents l, r; // here, and not in an array whose cache lines neighbours write to
                move(from + begin, from + end, is_left, to, share.left, right_end, l, r);
                share.extents[0] = l, share.extents[1] = r;
            });
            for (const Share& share : shares) {
                left.extents.extend(share.extents[0]);
                right.extents.extend(share.extents[1]);
            }
        }
        left.begin = part.begin, left.end = right.begin = middle, right.end = part.end;
        left.side = right.side = 1 - part.side;
    }

    // Halves the part by number, as it lies.
    void halve(const RefPart& part, RefPart& left, RefPart& right) const
    {
        const std::size_t middle = part.begin + (part.end - part.begin) / 2;
        left = {part.begin, middle, part.side, {}};
        right = {middle, part.end, part.side, {}};
        for (const PrimitiveRef& ref : range(left)) left.extents.extend(ref);
        for (const PrimitiveRef& ref : range(right)) right.extents.extend(ref);
    }

  private:
    // Of passes with several threads; fixed, for the result must not depend on their number.
    static constexpr std::size_t chunk_size = 1 << 15;

    struct Share
    {
        std::size_t left = 0; // references on the left; then, where they go
        Extents extents[2];
    };
    std::vector<PrimitiveRef> primitives_;
    Scratch<PrimitiveRef> scratch_;
    PrimitiveRef* sides_[2];

    static std::size_t chunks_of(const RefPart& part) { return (part.end - part.begin + chunk_size - 1) / chunk_size; }

    // Calls body(chunk, begin, end) for chunks of fixed size that cover the part.
    template <class Body>
    static void for_chunks(const RefPart& part, const Body& body)
    {
        parallel_for(chunks_of(part), [&](std::size_t chunk) {
            const std::size_t first = part.begin + chunk * chunk_size;
            body(chunk, first, std::min(first + chunk_size, part.end));
        });
    }

    // Those on the left go to to[left], to[left + 1], ..., the others to to[right - 1], to[right - 2], ... Returns one
    // past the last on the left.
    template <class IsLeft>
    static std::size_t move(const PrimitiveRef* begin, const PrimitiveRef* end, const IsLeft& is_left, PrimitiveRef* to,
                            std::size_t left, std::size_t right, Extents& left_extents, Extents& right_extents)
    {
        constexpr std::ptrdiff_t block = 256; // so few that they are still in the first-level cache for the extents
        while (begin < end) {
            const PrimitiveRef* stop = begin + std::min(block, end - begin);
            const std::size_t first = left, last = right;
            for (; begin < stop; ++begin) {
                // No branch: which side it is nobody can foresee.
                const std::size_t is = is_left(*begin) ? 1 : 0;
                to[right - 1 + ((0 - is) & (left - (right - 1)))] = *begin;
                left += is;
                right -= 1 - is;
            }
            for (std::size_t i = first; i < left; ++i) left_extents.extend(to[i]);
            for (std::size_t i = right; i < last; ++i) right_extents.extend(to[i]);
        }
        return left;
    }
};

} // namespace snell
