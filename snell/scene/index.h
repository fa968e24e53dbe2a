// How the parts of a scene refer to each other.
#pragma once

#include "snell/kernel/lang.h"

namespace snell {

// An index into the vector of T of one Scene.
template <class T>
struct Index
{
    uint value = none;

    bool valid() const { return value != none; }
    bool operator==(const Index&) const = default;
};

} // namespace snell
