// Numbers for the distinct corners of an OBJ file.
#pragma once

#include "snell/io/index_table.h"
#include "snell/kernel/scene_view.h"

namespace snell::obj {

// Gives equal triples (position, uv, normal) the same number, counting from 0 in order of first appearance, as an
// IndexTable does. But nearly always the triple is the first one of its position: a list by position finds that one
// where a hash table would miss the cache.
class CornerTable
{
  public:
    // position_count: how many positions there are so far. A corner may refer to later ones.
    uint find_or_add(uvec3 key, std::size_t position_count)
    {
        if (key.x >= position_count) { // not yet there; a list that long may never be justified
            has_forward_ = true;
            return find_or_add_other(key);
        }
        if (key.x >= first_.size()) first_.resize(position_count, none);
        uint& first = first_[key.x];
        if (first != none && keys_[first] == key) return first;
        if (first == none && !has_forward_) {
            keys_.push_back(key);
            return first = static_cast<uint>(keys_.size() - 1);
        }
        const uint found = find_or_add_other(key);
        if (first == none) first = found;
        return found;
    }

    // The distinct triples, by number.
    const std::vector<uvec3>& keys() const { return keys_; }
    std::vector<uvec3>& keys() { return keys_; }

    // Forgets what is only for finding.
    void finish()
    {
        first_ = {};
        others_ = IndexTable();
        other_numbers_ = {};
    }

  private:
    uint find_or_add_other(uvec3 key)
    {
        const uint k = others_.find_or_add(key);
        if (k == other_numbers_.size()) {
            other_numbers_.push_back(static_cast<uint>(keys_.size()));
            keys_.push_back(key);
        }
        return other_numbers_[k];
    }

    std::vector<uvec3> keys_;
    std::vector<uint> first_; // by position: the first triple with it, or none
    IndexTable others_;       // triples that are not
    std::vector<uint> other_numbers_;
    bool has_forward_ = false;
};

} // namespace snell::obj
