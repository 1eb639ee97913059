// Striation of muscles: parallel strands in bundles. Each strand has its own tone, and grooves between
// strands change the light. Strands finer than a pixel fade into their mean.

const float STRAND = 0.85, BUNDLE = 3.4;  // [mm] widths

struct Strand {
    float tone;
    float slope;  // slope of the height across the fibres
};

float chance(float number) {
    return fract(sin(number * 78.233) * 43758.5453);
}

// For strands `size` wide: x is the position across the strand, -0.5..0.5; y is the strand's number;
// z is its visibility, 0..1.
vec3 rounded(vec2 fibre, float size, float waviness) {
    float at = fibre.x / size + waviness * sin(fibre.y * 0.19 + 0.6 * fibre.x);
    return vec3(fract(at) - 0.5, floor(at), clamp(1.4 - 1.6 * fwidth(fibre.x) / size, 0.0, 1.0));
}

Strand strand_at(vec2 fibre) {
    vec3 fine = rounded(fibre, STRAND, 0.35), coarse = rounded(fibre, BUNDLE, 0.22);
    float grooves = 0.30 * fine.z * 4.0 * fine.x * fine.x + 0.34 * coarse.z * pow(abs(2.0 * coarse.x), 5.0);
    // The tone changes along a strand, as if strands ended and others began.
    float own = chance(fine.y + 31.0 * floor(fibre.y / 11.0 + 7.0 * chance(fine.y)));
    float tone = 1.12 + 0.22 * fine.z * (own - 0.5) + 0.14 * coarse.z * (chance(coarse.y + 0.5) - 0.5);
    return Strand(tone - grooves, -(0.9 * fine.z * fine.x + 0.8 * coarse.z * coarse.x));
}

// Tilts a normal by a slope across fibres, as bumps.glsl does for fine shape.
vec3 stranded(vec3 normal, vec3 position, float across, float slope) {
    vec3 along_x = dFdx(position), along_y = dFdy(position);
    vec3 first = cross(along_y, normal), second = cross(normal, along_x);
    float area = dot(along_x, first);
    vec3 gradient = slope * (dFdx(across) * first + dFdy(across) * second);
    return normalize(normal - gradient / (abs(area) < 1e-12 ? 1e-12 : area));
}
