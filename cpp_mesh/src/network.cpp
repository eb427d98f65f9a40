#include "network.hpp"

#include "errors.hpp"

namespace cpp_mesh {

namespace {

// Vertices added before the first vertex of the old polyline, or -1 if the old one is not part of
// the new.
int added_before(const Network& before, const Network& after, int f) {
    const int n_before = before.first[f + 1] - before.first[f];
    const int n_after = after.first[f + 1] - after.first[f];
    for (int shift = 0; shift + n_before <= n_after; ++shift) {
        bool is_same = true;
        for (int k = 0; k < n_before && is_same; ++k)
            is_same = before.xy[before.first[f] + k] == after.xy[after.first[f] + shift + k];
        if (is_same)
            return shift;
    }
    return -1;
}

} // namespace

Tolerances tolerances_for(const Rectangle& rectangle, double size) {
    Tolerances tolerances;
    // Coordinates far from the origin are known to fewer digits.
    const double farthest = std::max({std::abs(rectangle.x_min), std::abs(rectangle.x_max),
                                      std::abs(rectangle.y_min), std::abs(rectangle.y_max)});
    tolerances.same = std::max(1e-10 * std::min(size, rectangle.diagonal()), 1e-13 * farthest);
    tolerances.near_miss = 1e-3 * size;
    tolerances.angle = 3.0 * pi / 180.0;
    return tolerances;
}

std::vector<Segment> segments_of(const Network& network) {
    std::vector<Segment> segments;
    for (int f = 0; f < network.size(); ++f) {
        if (network.first[f + 1] - network.first[f] < 2)
            throw MeshError(
                {FaultKind::number, {fracture_culprit(f)}, {}, "{1} has fewer than two vertices"});
        double s = network.s_start[f];
        for (int v = network.first[f]; v + 1 < network.first[f + 1]; ++v) {
            Segment segment;
            segment.fracture = f;
            segment.end = {network.xy[v], network.xy[v + 1]};
            segment.s = {s, s + distance(network.xy[v], network.xy[v + 1])};
            s = segment.s[1];
            segments.push_back(segment);
        }
    }
    return segments;
}

std::vector<Segment> grown_segments(const Network& before, const Network& after) {
    if (after.size() != before.size())
        throw MeshError("the grown network has " + std::to_string(after.size()) +
                        " fractures instead of " + std::to_string(before.size()));
    const std::vector<Segment> all_before = segments_of(before), all_after = segments_of(after);
    std::vector<Segment> grown;
    std::size_t next = 0, next_before = 0;
    for (int f = 0; f < after.size(); ++f) {
        const int shift = added_before(before, after, f);
        if (shift < 0)
            throw MeshError(fracture_name(f) +
                            " has not only grown: its old vertices must stay as they are");
        const std::size_t n_before = before.first[f + 1] - before.first[f] - 1;
        const std::size_t n_after = after.first[f + 1] - after.first[f] - 1;
        const double s_shift = all_after[next + shift].s[0] - all_before[next_before].s[0];
        if (!(std::abs(s_shift) <=
              1e-9 * all_after[next + n_after - 1].s[1] - 1e-9 * all_after[next].s[0]))
            throw MeshError(fracture_name(f) + ": the arc length at its start does not fit its "
                                               "growth there");
        for (std::size_t k = 0; k < n_after; ++k)
            if (k < static_cast<std::size_t>(shift) || k >= shift + n_before)
                grown.push_back(all_after[next + k]);
        next += n_after;
        next_before += n_before;
    }
    return grown;
}

} // namespace cpp_mesh
