// The common area of two triangles, against areas known by hand.
#include "overlap.hpp"

#include "checks.hpp"

using cpp_mesh::common_area;
using cpp_mesh::Vec2;
using Corners = std::array<Vec2, 3>;

int main() {
    Checks checks;
    const Corners unit = {Vec2{0.0, 0.0}, Vec2{1.0, 0.0}, Vec2{0.0, 1.0}};
    checks.is_close(common_area(unit, unit), 0.5, 1e-16, "itself");
    checks.is_close(common_area(unit, {unit[1], unit[2], unit[0]}), 0.5, 1e-16, "itself, turned");
    checks.is_close(common_area(unit, {Vec2{0.1, 0.1}, Vec2{0.3, 0.1}, Vec2{0.1, 0.3}}), 0.02,
                    1e-16, "one inside the other");
    checks.is_close(common_area({Vec2{0.1, 0.1}, Vec2{0.3, 0.1}, Vec2{0.1, 0.3}}, unit), 0.02,
                    1e-16, "the other inside the one");
    checks.is_close(common_area(unit, {Vec2{1.0, 0.0}, Vec2{1.0, 1.0}, Vec2{0.0, 1.0}}), 0.0, 0.0,
                    "a common side");
    checks.is_close(common_area(unit, {Vec2{0.0, 0.0}, Vec2{-1.0, 0.0}, Vec2{0.0, -1.0}}), 0.0, 0.0,
                    "a common corner");
    checks.is_close(common_area(unit, {Vec2{2.0, 2.0}, Vec2{3.0, 2.0}, Vec2{2.0, 3.0}}), 0.0, 0.0,
                    "apart");
    // The square [0,1/2]^2 is the part of the unit triangle below and left of 1/2, within a large
    // one.
    checks.is_close(common_area(unit, {Vec2{0.5, 0.5}, Vec2{-3.0, 0.5}, Vec2{0.5, -3.0}}), 0.25,
                    1e-15, "a square");
    // Two opposite triangles form a hexagram: the hexagon is two thirds of each.
    const double h = std::sqrt(3.0) / 2.0;
    const Corners up = {Vec2{-0.5, -h / 3.0}, Vec2{0.5, -h / 3.0}, Vec2{0.0, 2.0 * h / 3.0}};
    const Corners down = {Vec2{0.5, h / 3.0}, Vec2{-0.5, h / 3.0}, Vec2{0.0, -2.0 * h / 3.0}};
    checks.is_close(common_area(up, down), 2.0 / 3.0 * h / 2.0, 1e-15, "a hexagram");
    // No digits are lost far from the origin (coordinates themselves are exact here).
    const double far = 4096.0;
    Corners up_far = unit, down_far = {Vec2{0.5, 0.5}, Vec2{-3.0, 0.5}, Vec2{0.5, -3.0}};
    for (int k = 0; k < 3; ++k) {
        up_far[k] = up_far[k] + Vec2{far, -far};
        down_far[k] = down_far[k] + Vec2{far, -far};
    }
    checks.is_close(common_area(up_far, down_far), 0.25, 1e-15, "far from the origin");
    return checks.finish();
}
