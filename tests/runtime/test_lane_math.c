/* The runtime's own elementary functions against libm in double precision. */
#include "lane_math.h"
#include "support.h"

/* Units in the last place of `exact`. */
static double ulps(float value, double exact)
{
    const float nearest = (float)exact;
    const double unit = (double)nextafterf(fabsf(nearest), INFINITY) - (double)fabsf(nearest);
    return fabs((double)value - exact) / unit;
}

static void test_atan2(void)
{
    uint64_t state = 1;
    double worst = 0.0;
    for (int i = 0; i < 2000000; ++i) {
        const float size = ldexpf(1.0f, (int)random_below(&state, 100) - 50);
        const float y = size * (2.0f * random_unit(&state) - 1.0f), x = size * (2.0f * random_unit(&state) - 1.0f);
        const double error = ulps(pliant_atan2(y, x), atan2((double)y, (double)x));
        if (error > worst) worst = error;
    }
    printf("atan2: %.2f ulp\n", worst);
    CHECK(worst <= 3.0, "%.2f ulp", worst);
    CHECK(pliant_atan2(0.0f, 1.0f) == 0.0f, "angle 0");
    CHECK(fabsf(pliant_atan2(0.0f, -1.0f) - 3.14159265f) < 1e-6f, "half turn");
    CHECK(fabsf(pliant_atan2(-1.0f, 0.0f) + 1.57079633f) < 1e-6f, "quarter turn back");
    CHECK(isnan(pliant_atan2(0.0f, 0.0f)), "a collapsed hinge must not pass for a flat one");
}

static void test_log1p_minus(void)
{
    uint64_t state = 2;
    double worst = 0.0;
    for (int i = 0; i < 2000000; ++i) {
        const float size = ldexpf(1.0f, (int)random_below(&state, 40) - 30); /* 2^-30 .. 2^9 */
        float u = size * (2.0f * random_unit(&state) - 1.0f);
        if (u <= -0.999f) u = -u;
        if (u == 0.0f) continue;
        /* log1p(u) - u cancels in double too below 1e-4: there the series is exact. */
        const double x = (double)u;
        const double exact
            = fabs(x) > 1e-3 ? log1p(x) - x : -x * x * (0.5 - x * (1.0 / 3.0 - x * (0.25 - x * (0.2 - x / 6.0))));
        const double error = ulps(pliant_log1p_minus(u), exact);
        if (error > worst) worst = error;
    }
    printf("log(1+u)-u: %.2f ulp\n", worst);
    CHECK(worst <= 8.0, "%.2f ulp", worst); /* next to the seam at sqrt(2), where three bits cancel */
    CHECK(pliant_log1p_minus(0.0f) == 0.0f, "at 0");
    for (float u = -0.999f; u > -0.9999999f; u = 0.5f * (u - 1.0f)) {
        const double exact = log1p((double)u) - (double)u;
        CHECK(ulps(pliant_log1p_minus(u), exact) <= 8.0, "u = %.9g", (double)u);
    }
}

static void test_cbrt(void)
{
    uint64_t state = 4;
    double worst = 0.0;
    for (int i = 0; i < 2000000; ++i) {
        const float v = ldexpf(0.5f + random_unit(&state), (int)random_below(&state, 240) - 120);
        const double error = ulps(pliant_cbrt(v), cbrt((double)v));
        if (error > worst) worst = error;
    }
    printf("cbrt: %.2f ulp\n", worst);
    CHECK(worst <= 1.5, "%.2f ulp", worst);
    CHECK(pliant_cbrt(1.0f) == 1.0f, "the root of 1 is %.9g: nothing may happen without deformation",
          (double)pliant_cbrt(1.0f));
    CHECK(fabsf(pliant_cbrt(5.96046448e-8f) - 0.00390625f) < 1e-9f, "2^-24, the smallest 1 + u");
}

static void test_expm1(void)
{
    uint64_t state = 5;
    double worst = 0.0;
    for (int i = 0; i < 2000000; ++i) {
        const float x = ldexpf(80.0f * (2.0f * random_unit(&state) - 1.0f), -(int)random_below(&state, 20));
        const double error = ulps(pliant_expm1(x), expm1((double)x));
        if (error > worst) worst = error;
    }
    printf("exp(x)-1: %.2f ulp\n", worst);
    CHECK(worst <= 2.0, "%.2f ulp", worst);
    CHECK(pliant_expm1(0.0f) == 0.0f, "at 0: layers at rest must change nothing");
    CHECK(isnan(pliant_expm1(NAN)), "what is no number must not become one");
}

static void test_sinh_ratio(void)
{
    uint64_t state = 6;
    double worst = 0.0;
    for (int i = 0; i < 2000000; ++i) {
        const float k = ldexpf(80.0f * random_unit(&state), -(int)random_below(&state, 40));
        const double exact = k > 0.0f ? sinh((double)k) / (double)k : 1.0;
        const double error = ulps(pliant_sinh_ratio(k, 1.0f + pliant_expm1(k)), exact);
        if (error > worst) worst = error;
    }
    printf("sinh(k)/k: %.2f ulp\n", worst);
    CHECK(worst <= 3.0, "%.2f ulp", worst);
    CHECK(pliant_sinh_ratio(0.0f, 1.0f) == 1.0f, "at 0");
}

static void test_wrap_angle(void)
{
    uint64_t state = 3;
    for (int i = 0; i < 1000000; ++i) {
        const float angle = 40.0f * (random_unit(&state) - 0.5f);
        const double pi = acos(-1.0);
        const double exact = remainder((double)angle, 2.0 * pi);
        double error = fabs((double)pliant_wrap_angle(angle) - exact);
        if (error > pi) error = fabs(error - 2.0 * pi); /* at half a turn either sign is right */
        CHECK(error < 5e-7, "angle %.9g", (double)angle);
    }
    CHECK(pliant_wrap_angle(1.5f) == 1.5f, "angles within half a turn stay as they are");
    CHECK(pliant_wrap_angle(1e30f) == pliant_wrap_angle(1e30f), "finite input, finite output");
}

int main(void)
{
    test_atan2();
    test_log1p_minus();
    test_cbrt();
    test_expm1();
    test_sinh_ratio();
    test_wrap_angle();
    return report("lane math");
}
