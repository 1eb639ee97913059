// An attribute edge: its number of splits (section 4.1), and the index of its points in the group.
uniform uint frame;
uniform bool is_rest;

float metric_of(float measure, float once, float width, float most) {
    precise float above = measure - once;
    return min(float(double(above) / double(width)), most);
}

uint split_of(uint e, bool is_original) {
    uint split = 0u;
    float metric = uintBitsToFloat(0xff800000u);  // the largest: above 0 for one split, 1 for two
#ifdef BY_NORMAL
    float cosine = exact_dot(normals(edge_points(4u * e)).xyz, normals(edge_points(4u * e + 1u)).xyz);
    precise float drop = rest_cosines(e) - cosine;
    // A cosine of -infinity at rest marks an edge whose normals are undefined: it is never split.
    if (is_rest && rest_cosines(e) == 0.0) work[rest_cosines_at + e] = floatBitsToUint(cosine);
#ifdef BLENDED
    metric = metric_of(drop, drop_once, drop_width, drop_most);
#else
    split = uint(drop > drop_once) + uint(drop > drop_twice);
#endif
#endif
#ifdef BY_DISPLACEMENT
    bool is_border = edge_points(4u * e + 2u) == edge_points(4u * e);
    float weight = is_border ? 8.0 : 1.0;  // refine/beyond/displacement.py
    float size = metric_of(weight * midpoints(e).w, size_once, size_width, size_most);
    if (size_soon < size_ramp && 0.0 < size && size < 1.0) {  // refine/beyond/displacement.py
        if (size < size_soon) {
            precise float sooner = size * size_slope;
            size = sooner;
        } else {
            precise float left = 1.0 - size, whole = 1.0 - size_soon, slope = 1.0 - size_ramp;
            precise float later = 1.0 - slope * float(double(left) / double(whole));
            size = later;
        }
    }
    metric = max(metric, size);
#endif
#ifdef BY_MEASURED  // by the processor, at rest or in this frame
    metric = max(metric, measured(e));
#endif
#ifdef CURVED
    if (is_original) {  // geomorph weights of its points
#ifdef BLENDED
        edge_normals(e).w = min(max(metric / 0.25, 0.0), 1.0);
        displacements(3u * e).w = min(max((metric - 1.0) / 0.25, 0.0), 1.0);
#else
        edge_normals(e).w = displacements(3u * e).w = 1.0;
#endif
    }
#endif
    return max(split, uint(metric > 0.0) + uint(metric > 1.0));
}

void main() {
    uint r = gl_GlobalInvocationID.x, split = 0u;
    if (r < attribute_edge_count && !(is_rest && r >= edge_count)) {
        uint e = attribute_edges(r);
        splits(r) = split = split_of(e, r < edge_count);
#ifndef CURVED  // all threads write the same number; it is never cleared
        if (split > 0u) moved_frames(edge_points(4u * e)) = moved_frames(edge_points(4u * e + 1u)) = frame;
#endif
    }
    uint before = exclusive_sum(split + (split >> 1), 0u);
    if (r < attribute_edge_count) first_points(r) = before;
}
