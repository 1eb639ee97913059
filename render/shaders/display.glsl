// Linear light -> the screen's numbers.

// Soft shoulder above 0.8, then linear light -> sRGB by square roots (max error 0.004, after
// I. Chilliant's fit): on software OpenGL half the cost of pow.
vec3 display(vec3 light) {
    vec3 over = max(light - 0.8, 0.0);
    light = min(light, 0.8) + over / (1.0 + 5.0 * over);
    vec3 root2 = sqrt(light);
    vec3 root4 = sqrt(root2);
    vec3 root8 = sqrt(root4);
    return 0.662002687 * root2 + 0.684122060 * root4 - 0.323583601 * root8 - 0.0225411470 * light;
}
