// A vertex: its normal, further from those of its neighbours than it is (refine/beyond/cubic.py).
void main() {
    uint v = gl_GlobalInvocationID.x;
    if (v >= vertex_count) return;
    precise vec3 around = vec3(0.0);
    for (uint k = neighbour_starts(v); k < neighbour_starts(v + 1u); ++k)
        around += tangent_normals(neighbours(k)).xyz;
    precise vec3 taken = neighbour_share(v) * around, left = tangent_normals(v).xyz - taken;
    steeper(v) = vec4(unit(left), 0.0);
}
