// Child words, as in snell/bvh/node.h.
const uint word_done = 0xffffffffu;
const uint word_world = 0xfffffffdu;
const uint child_index_mask = 0x3fffffffu;
const uint kind_node = 0u;
const uint kind_block = 1u;
const uint kind_sphere_block = 2u;
const uint kind_instance = 3u;
