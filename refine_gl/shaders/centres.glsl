// A triangle: its middle on the surface where every edge is split (refine/beyond/surface_normals.py).
FOR_EACH(t, face_count) {
    precise vec3 of_corners = vec3(0.0), of_middles = vec3(0.0);
    for (uint k = 0u; k < 3u; ++k) {
        uint e = triangle_edges(3u * t + k);
        of_corners += seen(faces(3u * t + k)).xyz;
        if (e != NONE) of_middles += middles(e).xyz;
    }
    precise vec3 out_of = of_middles - of_corners;
    centres(t) = vec4(weighed(1.0 / 3.0, of_corners, 0.511, out_of), 0.0);
}
