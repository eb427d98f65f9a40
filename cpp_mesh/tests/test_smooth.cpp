// Smoothing never makes the worst cell worse, never inverts one, and moves free nodes only.
#include "smooth.hpp"

#include "checks.hpp"

#include <cstdint>

using namespace cpp_mesh;

namespace {

constexpr int n = 12; // squares per side

double worst_shape(const PlaneMesh& mesh) {
    double worst = 1.0;
    for (const Triangle& cell : mesh.cells)
        worst = std::min(
            worst, sine_of_smallest_angle(mesh.xy[cell[0]], mesh.xy[cell[1]], mesh.xy[cell[2]]));
    return worst;
}

// Squares cut in two, boundary nodes first; inner nodes are moved at random by up to `amplitude`
// squares.
PlaneMesh perturbed(double amplitude, std::uint64_t seed) {
    const auto random = [&seed] { // linear congruential generator of Knuth's MMIX, -1 to 1
        seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
        return 2.0 * static_cast<double>(seed >> 11) / 9007199254740992.0 - 1.0;
    };
    PlaneMesh mesh;
    std::vector<int> number((n + 1) * (n + 1));
    for (const bool inner : {false, true})
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i)
                if ((i > 0 && i < n && j > 0 && j < n) == inner) {
                    number[j * (n + 1) + i] = static_cast<int>(mesh.xy.size());
                    const double a = inner ? amplitude : 0.0;
                    mesh.xy.push_back({i + a * random(), j + a * random()});
                }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int p = number[j * (n + 1) + i], q = number[j * (n + 1) + i + 1],
                      r = number[(j + 1) * (n + 1) + i + 1], s = number[(j + 1) * (n + 1) + i];
            mesh.cells.push_back({p, q, r});
            mesh.cells.push_back({p, r, s});
        }
    return mesh;
}

} // namespace

int main() {
    Checks checks;
    for (std::uint64_t seed = 1; seed <= 50; ++seed) {
        PlaneMesh mesh = perturbed(0.3, seed);
        const PlaneMesh before = mesh;
        const double worst = worst_shape(mesh);
        smooth(mesh, 4 * n);
        checks.is_true(worst_shape(mesh) > worst, "the worst cell becomes better");
        for (int node = 0; node < 4 * n; ++node)
            checks.is_true(mesh.xy[node] == before.xy[node], "fixed nodes stay");
        double area = 0.0;
        for (const Triangle& cell : mesh.cells) {
            const double twice = twice_area(mesh.xy[cell[0]], mesh.xy[cell[1]], mesh.xy[cell[2]]);
            if (worst > 0.0)
                checks.is_true(twice > 0.0, "no cell is inverted");
            area += 0.5 * twice;
        }
        checks.is_close(area, static_cast<double>(n) * n, 1e-11, "the area stays");
    }
    // The triangle's angles are 30, 60 and 90 degrees.
    checks.is_close(sine_of_smallest_angle({0.0, 0.0}, {std::sqrt(3.0), 0.0}, {0.0, 1.0}), 0.5,
                    1e-15, "smallest angle");
    checks.is_close(sine_of_smallest_angle({0.0, 0.0}, {0.0, 1.0}, {std::sqrt(3.0), 0.0}), -0.5,
                    1e-15, "smallest angle, inverted");
    return checks.finish();
}
