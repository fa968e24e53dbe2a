// Edits: small values that say what is to change in a scene. Each can be undone, and says what has to follow.
#pragma once

#include "snell/scene/change.h"
#include "snell/scene/scene.h"

#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace snell {

// "value": what it becomes, whole.
struct SetMaterial
{
    Index<MaterialDesc> material;
    MaterialDesc value;
};

// At the end of the list, so that no index changes.
struct AddMaterial
{
    MaterialDesc value;
};

// Takes the last one away; as the inverse of AddMaterial alone.
struct RemoveMaterial
{
};

// What of a mesh has the material `from` gets `to`, which the mesh must not have elsewhere: they could not be told
// apart again. For spheres and planes: SetSphere, SetPlane.
struct AssignMaterial
{
    Index<Mesh> mesh;
    Index<MaterialDesc> from, to;
};

// At the end of the list. The texels are shared by whoever holds the edit, and copied into the scene.
struct AddImage
{
    std::shared_ptr<const Image> value;
};

// Takes the last one away; as the inverse of AddImage alone.
struct RemoveImage
{
};

// Position and direction of a light on a node are the node's.
struct SetLight
{
    uint light = 0;
    LightDesc value;
};

struct AddLight
{
    uint at = 0; // those from there on move up
    LightDesc value;
};

struct RemoveLight
{
    uint at = 0; // those after it move down
};

// Eye, target and up of a camera on a node are the node's.
struct SetCamera
{
    uint camera = 0;
    CameraDesc value;
};

struct AddCamera
{
    uint at = 0;
    CameraDesc value;
};

struct RemoveCamera
{
    uint at = 0;
};

struct SetEnvironment
{
    EnvironmentDesc value;
};

// Of an instance that hangs on no node.
struct SetTransform
{
    uint instance = 0;
    Transform value = identity_transform();
};

// Translation, rotation, scale (or matrix) and weights of a node at rest; its name and parent stay. What hangs on it
// follows.
struct SetNode
{
    Index<Node> node;
    Node value;
};

struct SetSphere
{
    Index<SphereDesc> sphere;
    SphereDesc value;
};

struct SetPlane
{
    uint plane = 0;
    PlaneDesc value;
};

enum class ScenePart
{
    image,
    material,
    mesh,
    sphere,
    plane,
    group,
    instance,
    light,
    camera,
    node,
    animation
};

struct Rename
{
    ScenePart part = ScenePart::material;
    uint index = 0;
    std::string name;
};

using Edit = std::variant<SetMaterial, AddMaterial, RemoveMaterial, AssignMaterial, AddImage, RemoveImage, SetLight,
                          AddLight, RemoveLight, SetCamera, AddCamera, RemoveCamera, SetEnvironment, SetTransform,
                          SetNode, SetSphere, SetPlane, Rename>;

// What edits have to know beside the scene.
struct EditContext
{
    bool is_outline = false;    // the scene is an outline(): images are added without texels
    Index<Animation> animation; // the pose that the scene is in, as pose() takes it
    float seconds = 0.0f;
};

struct AppliedEdit
{
    Edit edit;    // as it was applied: with numbers mended
    Edit inverse; // brings back what was there, by reapply()
    uint changes = change_none;
    std::string mended; // in words; empty: nothing
};

// Applies one edit. Numbers that are not physical are mended as validate() mends those of files. Throws Error on what
// has no meaning (an index out of range, a singular transform, a picture of light as a reflectance, ...); nothing has
// changed then.
AppliedEdit apply_edit(Scene& scene, Edit edit, const EditContext& context = {});

// Applies one that apply_edit() gave, or its inverse, to a scene in the state for which it was made; does not look at
// its numbers again. Returns SceneChange bits.
uint reapply(Scene& scene, const Edit& edit, const EditContext& context = {});

// Whether b, right after a and by the same control, can take its place: both set the same thing.
bool sets_the_same(const Edit& a, const Edit& b);

// Memory that it holds.
std::size_t bytes_of(const Edit& edit);

} // namespace snell
