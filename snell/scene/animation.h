// What moves in a scene: a hierarchy of nodes, key frames for them, and meshes that follow them by skinning or
// morphing. The scene holds one pose at a time; pose() puts it into that of another moment. The parts are glTF 2.0's.
#pragma once

#include "snell/core/vec.h"
#include "snell/kernel/scene_view.h"
#include "snell/scene/index.h"

#include <optional>
#include <string>
#include <vector>

namespace snell {

struct Mesh;
struct Scene;

// A frame of reference that others hang on. Its map to the parent: scale first, then rotation, then translation. These
// are the node at rest, and pose() leaves them alone.
struct Node
{
    std::string name;
    Index<Node> parent; // not valid: the world
    vec3 translation{0.0f};
    vec4 rotation{0.0f, 0.0f, 0.0f, 1.0f}; // unit quaternion x y z w
    vec3 scale{1.0f};
    // A matrix that is no product of the three (it shears), in their place; it cannot be animated.
    bool has_matrix = false;
    Transform matrix{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    std::vector<float> weights; // of the morph targets of the meshes that hang on this node
    // The map to the parent that the last pose() gave it, where that is not the one at rest.
    std::optional<Transform> posed;
};

struct Skin
{
    std::string name;
    std::vector<Index<Node>> joints;
    std::vector<Transform> inverse_bind; // from the mesh's space into that of each joint at rest
};

// What one morph target adds at weight 1; each empty or as long as the mesh's positions.
struct MorphTarget
{
    std::vector<vec3> positions, normals, tangents;
};

// A mesh that changes its shape: what it is computed from. A mesh belongs to one rig at most.
struct Rig
{
    Index<Mesh> mesh;                     // its positions, normals and tangents are what pose() writes
    Index<Node> node;                     // has the weights of the targets
    std::vector<vec3> positions, normals; // at rest, as Mesh's
    std::vector<vec4> tangents;
    std::vector<MorphTarget> targets;
    Index<Skin> skin;          // not valid: not skinned. A skinned mesh is posed in world space
    std::vector<uvec4> joints; // of each vertex: indices into Skin::joints. With 8 influences there are two runs,
    std::vector<vec4> weights; // one after the other, each as long as positions; >= 0, sum 1
};

enum class AnimatedProperty
{
    translation, // 3 numbers
    rotation,    // 4: a quaternion
    scale,       // 3
    weights      // as many as the node has
};

enum class Interpolation
{
    step,
    linear, // rotations: along the shortest great arc
    cubic   // Hermite spline with tangents: three sets of numbers a key, in-tangent, value, out-tangent
};

struct AnimationChannel
{
    Index<Node> node;
    AnimatedProperty property = AnimatedProperty::translation;
    Interpolation interpolation = Interpolation::linear;
    std::vector<float> times;  // seconds, ascending
    std::vector<float> values; // times.size() sets of numbers, or three times as many
};

struct Animation
{
    std::string name;
    std::vector<AnimationChannel> channels;
    float duration = 0.0f; // seconds: the last key's time
};

// Puts nodes, instances, lights, cameras and rigged meshes where `animation` has them at `seconds` (before the first
// and after the last key: where those have them). Not valid: as the nodes are at rest. What the animation does not
// move is where the file has it, however the scene was posed before. Weights of the morph targets blend positions,
// normals and tangents; joints blend linearly. What a moment flattens to nothing (a scale of 0) is placed a million
// times smaller instead: instances must be invertible. Throws Error as check_animation() does.
void pose(Scene& scene, Index<Animation> animation, float seconds);

// The map of a node to the world in the current pose. Throws Error if a node is its own ancestor.
Transform node_to_world(const Scene& scene, Index<Node> node);

} // namespace snell
