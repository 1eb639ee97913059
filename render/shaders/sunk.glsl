// Greater depths for parts in front of a cut, so that opaque skin hides them even where they come out
// of it. Positions on the screen do not change.

uniform float cut_width;  // greatest distance that is added

float sunk_depth(vec4 position) {
    float beyond = clamp(dot(cut, position), 0.0, cut_width);
    vec4 sunk = projection * vec4(position.xyz * (1.0 + beyond / length(position.xyz)), 1.0);
    return sunk.z / sunk.w * (projection * position).w;
}
