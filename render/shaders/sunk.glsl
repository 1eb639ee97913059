// The depth of parts under skin that is cut open: in their place, but as deep as if they were farther
// off, so that whole skin hides them.

uniform float cut_width;

float sunk_depth(vec4 position) {
    float beyond = clamp(dot(cut, position), 0.0, cut_width);
    vec4 sunk = projection * vec4(position.xyz * (1.0 + beyond / length(position.xyz)), 1.0);
    return sunk.z / sunk.w * (projection * position).w;
}
