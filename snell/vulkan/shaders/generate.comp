#version 460
// Generate: the camera rays of a batch.
#include "snell/vulkan/shaders/stage.glsl"

void main()
{
    uint slot = gl_GlobalInvocationID.x;
    if (slot >= push.count) return;
    uint pixel = push.first_pixel + slot / push.samples;
    uint x = push.x0 + pixel % push.columns;
    uint y = push.y0 + pixel / push.columns;
    CameraPath path = generate_camera_path(job.params, x, y, push.first_sample + slot % push.samples, slot);
    store_path(0u, slot, path.ray, path.state);
    SampleSlot empty;
    for (int layer = 0; layer < 3; ++layer) empty.layers[layer] = vec3(0.0f);
    // What the camera does not see stays in the queue, with a ray that hits nothing and is not shaded. The rims of a lens
    // are black, not transparent.
    empty.sees_through = camera_sees(path.ray) || job.params.camera.model == camera_lens ? 0u : 1u;
    job.slots.at[slot] = empty;
}
