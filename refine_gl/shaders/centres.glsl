// A triangle: its middle on the surface where every edge is split (refine/beyond/surface_normals.py).
void main() {
    uint t = gl_GlobalInvocationID.x;
    if (t >= face_count) return;
    precise vec3 of_corners = vec3(0.0), of_middles = vec3(0.0);
    for (uint k = 0u; k < 3u; ++k) {
        uint e = triangle_edges(3u * t + k);
        of_corners += seen(faces(3u * t + k)).xyz;
        if (e != NONE) of_middles += middles(e).xyz;
    }
    precise vec3 out_of = of_middles - of_corners;
    precise vec3 mean = (1.0 / 3.0) * of_corners, full = 0.511 * out_of, centre = mean + full;
    centres(t) = vec4(centre, 0.0);
}
