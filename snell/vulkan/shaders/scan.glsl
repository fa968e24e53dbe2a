// Sums over the invocations of a workgroup. All of them have to call.
shared uint scan_values[64];

// The sum of what the invocations before this one have; total: of all.
uint sum_before(uint value, out uint total)
{
    uint i = gl_LocalInvocationIndex;
    scan_values[i] = value;
    barrier();
    for (uint step = 1u; step < 64u; step <<= 1u) {
        uint more = i >= step ? scan_values[i - step] : 0u;
        barrier();
        scan_values[i] += more;
        barrier();
    }
    total = scan_values[63];
    uint before = scan_values[i] - value;
    barrier();
    return before;
}

shared float add_values[64];

// The sum of all, in the same order in every run.
float sum_of_group(float value)
{
    uint i = gl_LocalInvocationIndex;
    add_values[i] = value;
    barrier();
    for (uint half_size = 32u; half_size > 0u; half_size >>= 1u) {
        if (i < half_size) add_values[i] += add_values[i + half_size];
        barrier();
    }
    float sum = add_values[0];
    barrier();
    return sum;
}
