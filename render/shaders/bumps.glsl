// Fine shape of a surface: normals and albedo of furrows from a map over the texture coordinates, as
// far as two amounts, interpolated from vertices, let them show (Blinn 1978).
// The gradient of a height on any surface, from screen-space derivatives: M. Mikkelsen, "Bump
// mapping unparametrized surfaces on the GPU", 2010; here the map knows the slopes along u and v.

uniform sampler2D bump_map;    // slope along u and v, depth of the furrow, which amount counts
uniform float bump_slope;      // height over texture coordinates of a full byte
uniform float bump_strength;
const vec3 FURROW = vec3(0.40, 0.50, 0.52);  // how much darker the deepest is; light in it is red

struct Bump {
    vec2 slope;  // of the height along u and v
    float depth;
};

Bump bump_at(vec2 uv, vec2 amounts) {
    vec4 texel = texture(bump_map, uv);
    float amount = bump_strength * mix(amounts.x, amounts.y, texel.a);
    vec2 slope = (texel.rg * 255.0 - 128.0) * (bump_slope / 127.0);
    return Bump(amount * slope, amount * texel.b);
}

// `normal` points out of the surface.
vec3 bumped(vec3 normal, vec3 position, vec2 uv, Bump bump) {
    vec3 along_x = dFdx(position), along_y = dFdy(position);
    float rise_x = dot(bump.slope, dFdx(uv)), rise_y = dot(bump.slope, dFdy(uv));
    vec3 first = cross(along_y, normal), second = cross(normal, along_x);
    float area = dot(along_x, first);
    vec3 gradient = (rise_x * first + rise_y * second) / (abs(area) < 1e-12 ? 1e-12 : area);
    return normalize(normal - gradient);
}
