#include "patch_choice.hpp"

namespace cpp_mesh {

namespace {

// Cells shorter than this times the size that is now wanted go: they have been made around a tip
// that has moved on.
constexpr double smallest_ratio = 0.77;

// So far around such tips, in radii of their rosettes.
constexpr double reach_of_rosettes = 7.0;

// Rosettes are the same if their radii differ by no more than rounding errors.
constexpr double same_radius = 1e-6;

class PatchChooser {
public:
    PatchChooser(const PatchRequest& request, PatchTask& task)
        : request_(request), task_(task), old_(task.old_mesh.plane) {
        patch_.is_made_anew = request.marked;
        patch_.rosette_stays.assign(old_.rosettes.size(), 0);
    }

    Patch run() {
        for (const RosettePlan& plan : task_.plans)
            if (const int k = rosette_of(plan); k >= 0)
                patch_.rosette_stays[k] = std::abs(plan.radius - old_.rosettes[k].radius) <=
                                          same_radius * old_.rosettes[k].radius;
        mark_growth();
        const std::vector<char> is_at_growth = patch_.is_made_anew;
        mark_unfit();
        do {
            make_simple(old_, task_.edges, patch_.is_made_anew);
        } while (give_up_cut_rosettes());
        patch_.parts = patch_parts(old_, task_.edges, patch_.is_made_anew);
        leave_small_parts(is_at_growth);
        std::vector<RosettePlan>& plans = task_.plans;
        plans.erase(std::remove_if(plans.begin(), plans.end(),
                                   [&](const RosettePlan& plan) { return stays(plan); }),
                    plans.end());
        return std::move(patch_);
    }

private:
    // The old rosette at the tip of a plan, -1: none.
    int rosette_of(const RosettePlan& plan) const {
        for (std::size_t k = 0; k < old_.rosettes.size(); ++k)
            if (old_.rosettes[k].tip_node == task_.node_of_point[plan.point])
                return static_cast<int>(k);
        return -1;
    }

    bool stays(const RosettePlan& plan) const {
        const int k = rosette_of(plan);
        return k >= 0 && patch_.rosette_stays[k];
    }

    // Cells around a segment, by the margin and a radius.
    void mark_around(const std::array<Vec2, 2>& segment, double radius) {
        const Vec2 middle = 0.5 * (segment[0] + segment[1]);
        mark_near(old_, segment, radius + request_.margin_in_cells * task_.made.size(middle),
                  patch_.is_made_anew);
    }

    void mark_rosette(const Rosette& rosette) {
        const Vec2 tip = old_.xy[rosette.tip_node];
        mark_around({tip, tip}, rosette.radius);
    }

    void mark_growth() {
        for (const std::array<Vec2, 2>& segment : request_.new_segments)
            mark_around(segment, 0.0);
        for (const RosettePlan& plan : task_.plans)
            if (!stays(plan)) {
                const Vec2 tip = task_.graph.points[plan.point].xy;
                mark_around({tip, tip}, plan.radius);
            }
        for (std::size_t k = 0; k < old_.rosettes.size(); ++k)
            if (!patch_.rosette_stays[k])
                mark_rosette(old_.rosettes[k]);
    }

    // Where sizes have become much smaller, or a tip has moved on.
    void mark_unfit() {
        std::vector<Rosette> gone;
        for (std::size_t k = 0; k < old_.rosettes.size(); ++k)
            if (!patch_.rosette_stays[k])
                gone.push_back(old_.rosettes[k]);
        for (std::size_t c = 0; c < old_.cells.size(); ++c) {
            const Triangle& node = old_.cells[c];
            const Vec2 p = old_.xy[node[0]], q = old_.xy[node[1]], r = old_.xy[node[2]];
            const Vec2 centre = (1.0 / 3.0) * (p + q + r);
            const double longest = std::max({distance(p, q), distance(q, r), distance(r, p)});
            const auto is_reached_by = [&](const Rosette& rosette) {
                return distance(centre, old_.xy[rosette.tip_node]) <
                       reach_of_rosettes * rosette.radius;
            };
            if (longest > request_.largest_ratio * request_.size(centre) ||
                (std::any_of(gone.begin(), gone.end(), is_reached_by) &&
                 longest < smallest_ratio * task_.made.size(centre)))
                patch_.is_made_anew[c] = 1;
        }
    }

    // A rosette with some cells in the patch is made again as a whole.
    bool give_up_cut_rosettes() {
        bool has_changed = false;
        for (std::size_t k = 0; k < old_.rosettes.size(); ++k) {
            const int tip = old_.rosettes[k].tip_node;
            if (!patch_.rosette_stays[k] || !patch_.touches(task_.edges, tip))
                continue;
            patch_.rosette_stays[k] = 0;
            has_changed = true;
            mark_rosette(old_.rosettes[k]);
        }
        return has_changed;
    }

    // Some cells of unfit size apart from the growth are not worth a patch of their own.
    void leave_small_parts(const std::vector<char>& is_at_growth) {
        const auto is_small = [&](const PatchPart& part) {
            return static_cast<int>(part.cells.size()) < request_.smallest_part &&
                   std::none_of(
                       part.cells.begin(), part.cells.end(),
                       [&](int c) { return is_at_growth[c] != 0; });
        };
        for (const PatchPart& part : patch_.parts)
            if (is_small(part))
                for (int c : part.cells)
                    patch_.is_made_anew[c] = 0;
        patch_.parts.erase(std::remove_if(patch_.parts.begin(), patch_.parts.end(), is_small),
                           patch_.parts.end());
    }

    const PatchRequest& request_;
    PatchTask& task_;
    const PlaneMesh& old_;
    Patch patch_;
};

} // namespace

Patch choose_patch(const PatchRequest& request, PatchTask& task) {
    return PatchChooser(request, task).run();
}

} // namespace cpp_mesh
