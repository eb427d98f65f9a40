// Targets of growing ends: the nearest point, exactly; a network that is joined there can be
// meshed.
#include "api_mesh.hpp"
#include "checks.hpp"

#include <cstdint>
#include <limits>

namespace {

cm_target target_of(Checks& checks, const cm_spec& spec, TestNetwork network, Point p, int fracture,
                    int end) {
    const cm_network view = network.view();
    cm_target target{};
    checks.is_true(cm_nearest_target(&spec, &view, p[0], p[1], fracture, end, &target) == 0,
                   cm_last_error());
    return target;
}

void is_target(Checks& checks, const cm_target& target, Point place, int fracture, double distance,
               const std::string& name) {
    checks.is_close(target.x, place[0], 1e-14, name + ": x");
    checks.is_close(target.y, place[1], 1e-14, name + ": y");
    checks.is_equal(target.fracture, fracture, name + ": fracture");
    checks.is_close(target.distance, distance, 1e-14, name + ": distance");
}

void known_targets(Checks& checks) {
    const cm_spec spec = rectangle_spec(1.0, 1.0, 0.02, 0.1);
    const Polyline level = {{0.3, 0.5}, {0.6, 0.5}}, upright = {{0.7, 0.2}, {0.7, 0.8}};
    cm_target target = target_of(checks, spec, TestNetwork({level, upright}), {0.6, 0.5}, 0, 2);
    is_target(checks, target, {0.7, 0.5}, 1, 0.1, "in front");
    checks.is_close(target.s, 0.3, 1e-14, "in front: arc length");
    target = target_of(checks, spec, TestNetwork({level, upright}), {0.65, 0.53}, 0, 2);
    is_target(checks, target, {0.7, 0.53}, 1, 0.05, "from a place to which it would grow");
    target = target_of(checks, spec, TestNetwork({level}), {0.3, 0.5}, 0, 1);
    is_target(checks, target, {0.0, 0.5}, -1, 0.3, "the boundary");
    checks.is_equal(target.side, 1, "the boundary: left side");
    target = target_of(checks, spec, TestNetwork({{{0.3, 0.5}, {0.65, 0.80005}}, upright}),
                       {0.65, 0.80005}, 0, 2);
    is_target(checks, target, {0.7, 0.8}, 1, std::hypot(0.05, 0.00005), "an end nearby");
    checks.is_close(target.s, 0.6, 1e-14, "an end nearby: arc length");
    target =
        target_of(checks, spec, TestNetwork({{{0.5, 0.5}, {0.02, 0.0201}}}), {0.02, 0.0001}, 0, 2);
    is_target(checks, target, {0.02, 0.0}, -1, 0.0001, "near a side");
    target = target_of(checks, spec, TestNetwork({{{0.5, 0.5}, {0.1, 0.1}}}), {0.0001, 0.05}, 0, 2);
    is_target(checks, target, {0.0, 0.05}, -1, 0.0001, "the side, not the corner");
    target = target_of(checks, spec, TestNetwork({{{0.5, 0.5}, {0.1, 0.1}}}), {0.01, 0.0001}, 0, 2);
    checks.is_equal(target.side, 3, "bottom side");
}

// What an end has come from is no target.
void behind(Checks& checks) {
    const cm_spec spec = rectangle_spec(1.0, 2.0, 0.02, 0.1);
    // A short edge crack: the opposite sides are its targets, not the one where it begins.
    cm_target target =
        target_of(checks, spec, TestNetwork({{{0.0, 1.0}, {0.1, 1.0}}}), {0.1, 1.0}, 0, 2);
    is_target(checks, target, {1.0, 1.0}, -1, 0.9, "an edge crack");
    // A wing that begins at a joint, and a third fracture farther away than the first.
    const Polyline line = {{0.2, 1.0}, {0.6, 1.0}}, wing = {{0.4, 1.0}, {0.42, 1.05}};
    target = target_of(checks, spec, TestNetwork({line, wing, {{0.2, 1.2}, {0.6, 1.2}}}),
                       {0.42, 1.05}, 1, 2);
    is_target(checks, target, {0.42, 1.2}, 2, 0.15, "a wing");
    // Just beyond a crossing.
    target =
        target_of(checks, spec, TestNetwork({line, {{0.4, 1.5}, {0.4, 0.97}}}), {0.4, 0.97}, 1, 2);
    is_target(checks, target, {0.4, 0.0}, -1, 0.97, "beyond a crossing");
    // A fracture that it passes alongside comes no nearer.
    target =
        target_of(checks, spec, TestNetwork({line, {{0.3, 1.03}, {0.5, 1.03}}}), {0.5, 1.03}, 1, 2);
    is_target(checks, target, {1.0, 1.03}, -1, 0.5, "alongside");
    // A kink by 120 degrees; a fracture that comes back to itself.
    const double c = 0.1 * std::cos(pi / 3.0), s = 0.1 * std::sin(pi / 3.0);
    target = target_of(checks, spec, TestNetwork({{{0.4, 1.0}, {0.5, 1.0}, {0.5 - c, 1.0 + s}}}),
                       {0.5 - c, 1.0 + s}, 0, 2);
    checks.is_equal(target.fracture, -1, "a kink: not its own other leg");
    target = target_of(checks, spec,
                       TestNetwork({{{0.3, 1.0}, {0.7, 1.0}, {0.7, 1.3}, {0.5, 1.3}, {0.5, 1.05}}}),
                       {0.5, 1.05}, 0, 2);
    is_target(checks, target, {0.5, 1.0}, 0, 0.05, "back to itself");
}

// A disc: the nearest point of a polygon of many edges, and its corners.
void oblique_boundary(Checks& checks) {
    std::vector<double> corners;
    std::vector<int32_t> sides(120, 5);
    for (int k = 0; k < 120; ++k) {
        corners.push_back(std::cos(2.0 * pi * k / 120.0));
        corners.push_back(std::sin(2.0 * pi * k / 120.0));
    }
    cm_spec spec = rectangle_spec(0.0, 0.0, 0.05, 0.2);
    spec.n_corners = 120;
    spec.corners = corners.data();
    spec.edge_side = sides.data();
    for (int k = 0; k < 40; ++k) {
        const double angle = 0.1571 * k;
        const Point tip = {0.93 * std::cos(angle), 0.93 * std::sin(angle)};
        const Polyline line = {{0.1 * std::cos(angle), 0.1 * std::sin(angle)}, tip};
        const cm_target target = target_of(checks, spec, TestNetwork({line}), tip, 0, 2);
        checks.is_equal(target.side, 5, "disc: side");
        const double apothem = std::cos(pi / 120.0);
        checks.is_true(target.distance >= apothem - 0.93 - 1e-14 && target.distance <= 0.07,
                       "disc: distance");
        ApiMesh mesh;
        checks.is_true(mesh.create(spec, TestNetwork({{line[0], tip, {target.x, target.y}}})),
                       "disc: " + mesh.error);
        checks.is_equal(mesh.counts.n_tips, 1, "disc: one end is on the boundary");
    }
}

// Ends everywhere near a network with joints and kinks: once joined, it can be meshed.
void joined(Checks& checks) {
    const std::vector<Polyline> others = {{{0.2, 0.5}, {0.5, 0.5}, {0.7, 0.62}},
                                          {{0.4, 0.3}, {0.45, 0.7}},
                                          {{0.0, 0.2}, {0.6, 0.25}}};
    cm_spec spec = rectangle_spec(1.0, 1.0, 0.02, 0.1);
    spec.rosette_sectors = 8;
    spec.rosette_radius = 0.02;
    std::uint64_t seed = 7;
    const auto random = [&seed] { // linear congruential generator of Knuth's MMIX, 0 to 1
        seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
        return static_cast<double>(seed >> 11) / 9007199254740992.0;
    };
    int n_joined = 0, n_t = 0;
    for (int trial = 0; trial < 400; ++trial) {
        const Point tip = {0.02 + 0.96 * random(), 0.02 + 0.96 * random()};
        const double angle = 2.0 * pi * random();
        const Point start = {tip[0] + 0.03 * std::cos(angle), tip[1] + 0.03 * std::sin(angle)};
        std::vector<Polyline> fractures = others;
        fractures.push_back({start, tip});
        TestNetwork network(fractures);
        const cm_network view = network.view();
        cm_target target{};
        if (cm_nearest_target(&spec, &view, tip[0], tip[1], 3, 2, &target) != 0)
            continue; // the fracture already crosses or misses others too narrowly
        if (target.distance > 0.06)
            continue;
        const Point d = {target.x - tip[0], target.y - tip[1]};
        const double turn = std::acos(std::clamp(
            ((tip[0] - start[0]) * d[0] + (tip[1] - start[1]) * d[1]) / (0.03 * target.distance),
            -1.0, 1.0));
        if (turn > 0.5 * pi)
            continue; // growth does not turn back
        fractures.back().push_back({target.x, target.y});
        ApiMesh mesh;
        checks.is_true(mesh.create(spec, TestNetwork(fractures)), "joined: " + mesh.error);
        const int kind = mesh.kind({target.x, target.y});
        checks.is_true(kind >= 2, "joined: kind " + std::to_string(kind));
        n_t += kind == 3;
        ++n_joined;
    }
    checks.is_true(n_joined >= 30 && n_t >= 15,
                   "joined: cases, " + std::to_string(n_joined) + ", T " + std::to_string(n_t));
}

void refusals(Checks& checks) {
    const cm_spec spec = rectangle_spec(1.0, 1.0, 0.02, 0.1);
    TestNetwork network({{{0.3, 0.5}, {0.6, 0.5}}});
    const cm_network view = network.view();
    cm_target target{};
    for (const int fracture : {-1, 1})
        checks.is_true(cm_nearest_target(&spec, &view, 0.6, 0.5, fracture, 2, &target) != 0,
                       "no such fracture");
    for (const int end : {0, 3})
        checks.is_true(cm_nearest_target(&spec, &view, 0.6, 0.5, 0, end, &target) != 0,
                       "no such end");
    const double nan = std::numeric_limits<double>::quiet_NaN();
    checks.is_true(cm_nearest_target(&spec, &view, nan, 0.5, 0, 2, &target) != 0, "no number");
}

} // namespace

int main() {
    Checks checks;
    known_targets(checks);
    behind(checks);
    oblique_boundary(checks);
    joined(checks);
    refusals(checks);
    return checks.finish();
}
