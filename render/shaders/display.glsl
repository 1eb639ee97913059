// Converts linear light to sRGB.

// A soft shoulder compresses light above 0.8. Then square roots approximate sRGB (I. Chilliant's fit,
// greatest error 0.004), which takes half the time of pow on software OpenGL.
vec3 display(vec3 light) {
    vec3 over = max(light - 0.8, 0.0);
    light = min(light, 0.8) + over / (1.0 + 5.0 * over);
    vec3 root2 = sqrt(light);
    vec3 root4 = sqrt(root2);
    vec3 root8 = sqrt(root4);
    return 0.662002687 * root2 + 0.684122060 * root4 - 0.323583601 * root8 - 0.0225411470 * light;
}
