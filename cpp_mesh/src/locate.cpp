#include "locate.hpp"

namespace cpp_mesh {

namespace {

// Points this far outside, relative to the box of the mesh, count as on its boundary.
constexpr double tolerance = 1e-12;

} // namespace

CellBins::CellBins(const std::vector<Vec2>& xy, const std::vector<Triangle>& cells,
                   std::vector<int> members)
    : xy_(xy), cells_(cells) {
    if (members.empty()) {
        first_.assign(2, 0);
        return;
    }
    low_ = high_ = xy[cells[members[0]][0]];
    for (int c : members) {
        for (int node : cells[c]) {
            low_ = {std::min(low_.x, xy[node].x), std::min(low_.y, xy[node].y)};
            high_ = {std::max(high_.x, xy[node].x), std::max(high_.y, xy[node].y)};
        }
    }
    n_ = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(members.size()))), 1, 512);
    const auto each_bin = [&](int c, auto&& action) {
        const Vec2 p = xy_[cells_[c][0]], q = xy_[cells_[c][1]], r = xy_[cells_[c][2]];
        const int x0 = column(std::min({p.x, q.x, r.x})), x1 = column(std::max({p.x, q.x, r.x}));
        const int y0 = row(std::min({p.y, q.y, r.y})), y1 = row(std::max({p.y, q.y, r.y}));
        for (int y = y0; y <= y1; ++y)
            for (int x = x0; x <= x1; ++x)
                action(y * n_ + x);
    };
    first_.assign(n_ * n_ + 1, 0);
    for (int c : members)
        each_bin(c, [&](int bin) { ++first_[bin + 1]; });
    for (int bin = 0; bin < n_ * n_; ++bin)
        first_[bin + 1] += first_[bin];
    members_.resize(first_.back());
    std::vector<int> next(first_.begin(), first_.end() - 1);
    for (int c : members)
        each_bin(c, [&](int bin) { members_[next[bin]++] = c; });
}

int CellBins::column(double x) const {
    const double share = (x - low_.x) / (high_.x - low_.x);
    return std::clamp(static_cast<int>(std::floor(share * n_)), 0, n_ - 1);
}

int CellBins::row(double y) const {
    const double share = (y - low_.y) / (high_.y - low_.y);
    return std::clamp(static_cast<int>(std::floor(share * n_)), 0, n_ - 1);
}

int CellBins::locate(Vec2 p) const {
    const double slack = tolerance * std::max(high_.x - low_.x, high_.y - low_.y);
    if (!(p.x >= low_.x - slack && p.x <= high_.x + slack && p.y >= low_.y - slack &&
          p.y <= high_.y + slack))
        return -1;
    // The cell in which the point lies deepest; a point on an edge may round to just outside of
    // both.
    int best = -1;
    double best_depth = -slack;
    const int bin = row(p.y) * n_ + column(p.x);
    for (int k = first_[bin]; k < first_[bin + 1]; ++k) {
        const Triangle& cell = cells_[members_[k]];
        double depth = high_.x - low_.x + high_.y - low_.y;
        for (int i = 0; i < 3; ++i) {
            const Vec2 a = xy_[cell[i]], b = xy_[cell[(i + 1) % 3]];
            depth = std::min(depth, twice_area(a, b, p) / distance(a, b));
        }
        if (depth > best_depth) {
            best = members_[k];
            best_depth = depth;
        }
    }
    return best;
}

void CellBins::candidates(Vec2 low, Vec2 high, std::vector<int>& found) const {
    found.clear();
    for (int y = row(low.y); y <= row(high.y); ++y)
        for (int x = column(low.x); x <= column(high.x); ++x)
            found.insert(found.end(), members_.begin() + first_[y * n_ + x],
                         members_.begin() + first_[y * n_ + x + 1]);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
}

} // namespace cpp_mesh
