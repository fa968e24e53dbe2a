// GLSL leaves the rounding of its built-in functions open. For the exact build (TWIN_EXACT) those that are made of
// additions, multiplications, divisions and square roots are replaced by what glm computes. What remains is pow, exp,
// log and the trigonometric functions: see TWIN_BUILTIN in twin.h.
#define dot exact_dot
#define cross exact_cross
#define length exact_length
#define normalize exact_normalize
#define mix exact_mix
#define clamp exact_clamp
#define max exact_max
#define min exact_min

float exact_dot(vec2 a, vec2 b) { return a.x * b.x + a.y * b.y; }
float exact_dot(vec3 a, vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
float exact_dot(vec4 a, vec4 b) { return (a.x * b.x + a.y * b.y) + (a.z * b.z + a.w * b.w); }
vec3 exact_cross(vec3 a, vec3 b) { return vec3(a.y * b.z - b.y * a.z, a.z * b.x - b.z * a.x, a.x * b.y - b.x * a.y); }
float exact_length(vec2 v) { return sqrt(exact_dot(v, v)); }
float exact_length(vec3 v) { return sqrt(exact_dot(v, v)); }
vec2 exact_normalize(vec2 v) { return v * (1.0f / sqrt(exact_dot(v, v))); }
vec3 exact_normalize(vec3 v) { return v * (1.0f / sqrt(exact_dot(v, v))); }

float exact_mix(float a, float b, float t) { return a * (1.0f - t) + b * t; }
vec2 exact_mix(vec2 a, vec2 b, float t) { return a * (1.0f - t) + b * t; }
vec3 exact_mix(vec3 a, vec3 b, float t) { return a * (1.0f - t) + b * t; }
vec4 exact_mix(vec4 a, vec4 b, float t) { return a * (1.0f - t) + b * t; }

float exact_max(float a, float b) { return a < b ? b : a; }
float exact_min(float a, float b) { return b < a ? b : a; }
uint exact_max(uint a, uint b) { return a < b ? b : a; }
uint exact_min(uint a, uint b) { return b < a ? b : a; }
int exact_max(int a, int b) { return a < b ? b : a; }
int exact_min(int a, int b) { return b < a ? b : a; }
vec2 exact_max(vec2 a, vec2 b) { return vec2(max(a.x, b.x), max(a.y, b.y)); }
vec2 exact_min(vec2 a, vec2 b) { return vec2(min(a.x, b.x), min(a.y, b.y)); }
vec3 exact_max(vec3 a, vec3 b) { return vec3(max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)); }
vec3 exact_min(vec3 a, vec3 b) { return vec3(min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)); }
vec3 exact_max(vec3 a, float b) { return max(a, vec3(b)); }
vec3 exact_min(vec3 a, float b) { return min(a, vec3(b)); }

float exact_clamp(float x, float low, float high) { return min(max(x, low), high); }
int exact_clamp(int x, int low, int high) { return min(max(x, low), high); }
uint exact_clamp(uint x, uint low, uint high) { return min(max(x, low), high); }
vec2 exact_clamp(vec2 x, float low, float high) { return min(max(x, vec2(low)), vec2(high)); }
vec3 exact_clamp(vec3 x, float low, float high) { return min(max(x, vec3(low)), vec3(high)); }
vec3 exact_clamp(vec3 x, vec3 low, vec3 high) { return min(max(x, low), high); }
