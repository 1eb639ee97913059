// Light that reaches a part through an opening in the skin. FILLED: the part fills the opening, like an
// eyeball. BEHIND: the part lies behind it, like teeth. LIPS: the part is the skin around it. See
// opening.py. Constants are chosen by eye.

#if defined(FILLED)

// Planes that give coordinates in the opening: x from -1 to 1 between the corners, and y upward. The
// unit is half the opening's width.
uniform vec4 opening_x;
uniform vec4 opening_y;
uniform vec4 upper_lid;  // coefficients of y for 1, x, x^2, x^3
uniform vec4 lower_lid;
// Width of the shade of lids and corners, in half widths of the opening, and fraction of lost light.
const float REACH_ABOVE = 0.34, REACH_BELOW = 0.10, REACH_ASIDE = 0.52;
const float SHADE_ABOVE = 0.72, SHADE_BELOW = 0.35, SHADE_ASIDE = 0.42;

float light_let_in(vec3 place) {
    float x = clamp(dot(opening_x, vec4(place, 1.0)), -1.0, 1.0);
    float y = dot(opening_y, vec4(place, 1.0));
    vec4 powers = vec4(1.0, x, x * x, x * x * x);
    float above = max(dot(upper_lid, powers) - y, 0.0) / REACH_ABOVE;
    float below = max(y - dot(lower_lid, powers), 0.0) / REACH_BELOW;
    float aside = (1.0 - abs(x)) / REACH_ASIDE;
    return (1.0 - SHADE_ABOVE * exp2(-above * above)) * (1.0 - SHADE_BELOW * exp2(-below * below))
        * (1.0 - SHADE_ASIDE * exp2(-aside * aside));
}

#else

uniform vec3 rim[RIM_POINTS];  // clockwise seen from outside, the upper half first
const float GAIN = 4.6;     // amplification, because teeth and cheeks reflect light several times
const float LEAST = 0.12;   // fraction of light in a mouth that is nearly shut
const float TURNED = 0.35;  // weight of the surface's orientation
// Width of the shade of the upper lip and of the corners, in widths of the opening, and fraction of
// light that is lost in it.
const float REACH_ABOVE = 0.17, REACH_ASIDE = 0.26;
const float SHADE_ABOVE = 0.5, SHADE_ASIDE = 0.85;

// Distance of a point from the upper half of the rim.
float distance_above(vec3 place) {
    float nearest = 1e12;
    for (int i = 0; i < RIM_POINTS / 2; i++) {
        vec3 along = rim[i + 1] - rim[i];
        float share = clamp(dot(place - rim[i], along) / max(dot(along, along), 1e-9), 0.0, 1.0);
        vec3 away = place - rim[i] - share * along;
        nearest = min(nearest, dot(away, away));
    }
    return sqrt(nearest);
}

// Fraction of light that arrives at a point. It depends on the form factor of the opening, computed
// from its outline (J. H. Lambert 1760, Photometria).
float light_let_in(vec3 place, vec3 normal) {
    vec3 sum = vec3(0.0), outward = vec3(0.0), middle = vec3(0.0);
    vec3 from = rim[RIM_POINTS - 1] - place;
    for (int i = 0; i < RIM_POINTS; i++) {
        vec3 to = rim[i] - place;
        vec3 axis = cross(to, from);
        float sine = length(axis);
        sum += axis * (atan(sine, dot(from, to)) / max(sine, 1e-9));
        outward += axis;
        middle += to / float(RIM_POINTS);
        from = to;
    }
    const float WHOLE = 6.2831853;
    float seen = length(sum) / WHOLE;
    float toward = 0.5 + 0.5 * dot(normal, sum) / max(length(sum), 1e-9);
    float open = mix(LEAST, 1.0, 1.0 - exp2(-GAIN * seen * mix(1.0, toward, TURNED)));
    float width = max(distance(rim[0], rim[RIM_POINTS / 2]), 1e-6);
    float above = distance_above(place) / (REACH_ABOVE * width);
    float aside = min(distance(place, rim[0]), distance(place, rim[RIM_POINTS / 2])) / (REACH_ASIDE * width);
    open *= (1.0 - SHADE_ABOVE * exp2(-above * above)) * (1.0 - SHADE_ASIDE * exp2(-aside * aside));
    // Points in front of the mouth get all light.
    float out_by = -dot(middle, outward) / max(length(outward), 1e-9);
    return mix(open, 1.0, smoothstep(-0.04, 0.10, out_by / width));
}

#endif

// Colours light that red flesh has reflected.
vec3 reddened(float light) {
    return pow(vec3(light), vec3(0.80, 1.08, 1.12));
}
