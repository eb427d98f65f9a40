#include "locate.hpp"

#include <algorithm>
#include <numeric>

namespace cpp_mesh {

namespace {

// Points this far outside, relative to the box of the mesh, count as on its boundary.
constexpr double tolerance = 1e-12;

constexpr int leaf_size = 4;

std::vector<int> count_up(std::size_t n) {
    std::vector<int> numbers(n);
    std::iota(numbers.begin(), numbers.end(), 0);
    return numbers;
}

} // namespace

CellTree::CellTree(const std::vector<Vec2>& xy, const std::vector<Triangle>& cells)
    : CellTree(xy, cells, count_up(cells.size())) {}

CellTree::CellTree(const std::vector<Vec2>& xy, const std::vector<Triangle>& cells,
                   std::vector<int> members)
    : xy_(xy), cells_(cells), members_(std::move(members)) {
    if (!members_.empty())
        grow(0, static_cast<int>(members_.size()));
}

CellTree::Box CellTree::box_of(int cell) const {
    const Vec2 p = xy_[cells_[cell][0]], q = xy_[cells_[cell][1]], r = xy_[cells_[cell][2]];
    return {{std::min({p.x, q.x, r.x}), std::min({p.y, q.y, r.y})},
            {std::max({p.x, q.x, r.x}), std::max({p.y, q.y, r.y})}};
}

// Halve the members by the middles of their boxes, across the longer side of the whole.
void CellTree::grow(int first, int last) {
    const int here = static_cast<int>(branches_.size());
    Branch branch;
    branch.first = first;
    branch.last = last;
    branch.box = box_of(members_[first]);
    for (int k = first + 1; k < last; ++k) {
        const Box box = box_of(members_[k]);
        branch.box.low = {std::min(branch.box.low.x, box.low.x),
                          std::min(branch.box.low.y, box.low.y)};
        branch.box.high = {std::max(branch.box.high.x, box.high.x),
                           std::max(branch.box.high.y, box.high.y)};
    }
    branches_.push_back(branch);
    if (last - first <= leaf_size)
        return;
    const Vec2 extent = branch.box.high - branch.box.low;
    const auto key = [&](int cell) {
        const Box box = box_of(cell);
        return extent.x > extent.y ? box.low.x + box.high.x : box.low.y + box.high.y;
    };
    const int middle = (first + last) / 2;
    std::nth_element(members_.begin() + first, members_.begin() + middle, members_.begin() + last,
                     [&](int a, int b) {
                         const double key_a = key(a), key_b = key(b);
                         return key_a != key_b ? key_a < key_b : a < b;
                     });
    grow(first, middle);
    branches_[here].right = static_cast<int>(branches_.size());
    grow(middle, last);
}

template <typename Action> void CellTree::visit(Vec2 low, Vec2 high, Action&& action) const {
    if (branches_.empty())
        return;
    std::array<int, 64> waiting; // halves: no deeper than the bits of an index
    int n_waiting = 0;
    waiting[n_waiting++] = 0;
    while (n_waiting > 0) {
        const int here = waiting[--n_waiting];
        const Branch& branch = branches_[here];
        if (!branch.box.touches(low, high))
            continue;
        if (branch.right < 0) {
            for (int k = branch.first; k < branch.last; ++k)
                action(members_[k]);
        } else {
            waiting[n_waiting++] = branch.right;
            waiting[n_waiting++] = here + 1;
        }
    }
}

// Distance from the cell's nearest edge; negative outside.
double CellTree::depth_in(int cell, Vec2 p) const {
    const Triangle& node = cells_[cell];
    const auto height = [&](int i) {
        const Vec2 a = xy_[node[i]], b = xy_[node[(i + 1) % 3]];
        return twice_area(a, b, p) / distance(a, b);
    };
    return std::min({height(0), height(1), height(2)});
}

int CellTree::locate(Vec2 p, int guess) const {
    if (branches_.empty())
        return -1;
    const Vec2 extent = branches_[0].box.high - branches_[0].box.low;
    const double slack = tolerance * std::max(extent.x, extent.y);
    // What lies so deep in a cell lies in no other.
    if (guess >= 0 && depth_in(guess, p) > 2.0 * slack)
        return guess;
    // The cell in which the point lies deepest; a point on an edge may round to just outside of
    // both.
    int best = -1;
    double best_depth = -slack;
    visit(p - Vec2{slack, slack}, p + Vec2{slack, slack}, [&](int cell) {
        const double depth = depth_in(cell, p);
        if (depth > best_depth || (depth == best_depth && best >= 0 && cell < best)) {
            best = cell;
            best_depth = depth;
        }
    });
    return best;
}

void CellTree::candidates(Vec2 low, Vec2 high, std::vector<int>& found) const {
    found.clear();
    visit(low, high, [&](int cell) {
        if (box_of(cell).touches(low, high))
            found.push_back(cell);
    });
    std::sort(found.begin(), found.end());
}

} // namespace cpp_mesh
