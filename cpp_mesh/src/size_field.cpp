#include "size_field.hpp"

#include <limits>

namespace cpp_mesh {

namespace {

// Share of the distance to the farthest point at which cells have grown to their full size: the
// farthest point is a corner, and most of the boundary, which is nearer, should have cells of full
// size too.
constexpr double reach = 0.5;

// How far outside a disc cells grow by its slope, in radii, before they grow faster.
constexpr double near_part = 2.0;

// The farthest point is looked for on a grid: sizes depend on it only weakly.
constexpr int search_intervals = 32;

} // namespace

SizeField::SizeField(std::vector<SizeSource> sources, const Domain& domain, double size_far)
    : sources_(std::move(sources)), largest_(size_far) {
    if (sources_.empty())
        return;
    const Rectangle& rectangle = domain.box();
    double farthest = 0.0;
    for (int i = 0; i <= search_intervals; ++i) {
        for (int j = 0; j <= search_intervals; ++j) {
            const Vec2 p = {rectangle.x_min + rectangle.width() * i / search_intervals,
                            rectangle.y_min + rectangle.height() * j / search_intervals};
            double nearest = std::numeric_limits<double>::max();
            for (const SizeSource& source : sources_) {
                nearest = std::min(nearest, distance_to_segment(p, source.a, source.b));
                if (nearest <= farthest)
                    break;
            }
            if (nearest > farthest && (domain.is_rectangle() || domain.depth(p) >= 0.0))
                farthest = nearest;
        }
    }
    double smallest = size_far;
    for (const SizeSource& source : sources_)
        smallest = std::min(smallest, source.size);
    slope_ = (size_far - smallest) / (reach * farthest);
}

SizeField SizeField::less(const SizeField& other) const {
    SizeField rest;
    rest.largest_ = std::numeric_limits<double>::max();
    rest.slope_ = slope_;
    for (const SizeSource& source : sources_)
        if (std::none_of(other.sources_.begin(), other.sources_.end(), [&](const SizeSource& s) {
                return s.a == source.a && s.b == source.b && s.size == source.size;
            }))
            rest.sources_.push_back(source);
    for (const SizeDisc& disc : discs_)
        if (std::none_of(other.discs_.begin(), other.discs_.end(), [&](const SizeDisc& d) {
                return d.centre == disc.centre && d.radius == disc.radius && d.size == disc.size;
            }))
            rest.discs_.push_back(disc);
    return rest;
}

double SizeFoci::from_nearest(Vec2 p) const {
    double nearest = std::numeric_limits<double>::max();
    for (const Vec2& place : places)
        nearest = std::min(nearest, distance(p, place));
    return nearest;
}

double SizeFoci::up_to(double most, Vec2 p) const {
    return places.empty() ? 0.0 : std::min(size + slope * from_nearest(p), most);
}

double SizeFoci::at_corner(double smallest, Vec2 p) const {
    return places.empty() ? smallest : smallest * std::max(1.0, from_nearest(p) / size);
}

double SizeDisc::operator()(Vec2 p) const {
    const double outside = std::max(0.0, distance(p, centre) - radius);
    return size + slope * outside + far_more * std::max(0.0, outside - near_part * radius);
}

double SizeField::operator()(Vec2 p) const {
    double size = wanted_ != nullptr ? (*wanted_)(p) : largest_;
    const auto by_source = [&](int k) {
        const SizeSource& source = sources_[k];
        const double here = source.size + slope_ * distance_to_segment(p, source.a, source.b);
        if (source.largest > 0.0 && here < size)
            size = std::min(size, std::max(here, foci_.up_to(source.largest, p)));
        else
            size = std::min(size, here);
    };
    source_tree_.lower(p, size, by_source);
    for (int k = source_tree_.size(); k < static_cast<int>(sources_.size()); ++k)
        by_source(k);
    if (!foci_.places.empty() && std::none_of(sources_.begin(), sources_.end(),
                                              [](const SizeSource& s) { return s.largest > 0.0; }))
        size = std::max(size, foci_(p));
    const auto by_disc = [&](int k) { size = std::min(size, discs_[k](p)); };
    disc_tree_.lower(p, size, by_disc);
    for (int k = disc_tree_.size(); k < static_cast<int>(discs_.size()); ++k)
        by_disc(k);
    return size;
}

void SizeField::arrange() {
    std::vector<SizeTree::Bound> items;
    for (const SizeSource& source : sources_)
        items.push_back({{std::min(source.a.x, source.b.x), std::min(source.a.y, source.b.y)},
                         {std::max(source.a.x, source.b.x), std::max(source.a.y, source.b.y)},
                         source.size,
                         slope_,
                         0.0});
    source_tree_ = SizeTree(items);
    items.clear();
    for (const SizeDisc& disc : discs_)
        items.push_back({disc.centre, disc.centre, disc.size, disc.slope, disc.radius});
    disc_tree_ = SizeTree(items);
}

namespace {

// Cells counted from the start of a segment, at samples along it.
struct CellCount {
    std::vector<double> t, cells;
    bool is_even = false;    // samples
    bool is_uniform = false; // sizes
    bool is_resolved = true; // by the samples
};

// Samples a quarter of the size apart wherever they are; sizes may differ by orders of magnitude.
CellCount count_cells(Vec2 a, Vec2 b, const SizeField& size) {
    constexpr double step_in_sizes = 0.25, largest_step = 1.0 / 16.0;
    const double whole = distance(a, b);
    CellCount count{{0.0}, {0.0}};
    double here = size(a);
    while (count.t.back() < 1.0) {
        const double t = count.t.back();
        double next = t + std::min(step_in_sizes * here / whole, largest_step);
        if (next > 1.0 - 1e-6 * (next - t))
            next = 1.0;
        const double there = size(along(a, b, next));
        count.cells.push_back(count.cells.back() +
                              0.5 * (1.0 / here + 1.0 / there) * (next - t) * whole);
        count.t.push_back(next);
        here = there;
    }
    return count;
}

// Evenly spaced samples. They do not resolve sizes that differ by more than this factor from one to
// the next.
constexpr double largest_jump = 2.0;

CellCount count_cells_evenly(Vec2 a, Vec2 b, const SizeField& size) {
    const double whole = distance(a, b);
    double smallest_seen = size(a);
    for (int k = 1; k <= 8; ++k)
        smallest_seen = std::min(smallest_seen, size(along(a, b, 0.125 * k)));
    const double nudge = size.is_scale_free() ? tie_margin : 0.0;
    const int n_samples = static_cast<int>(
        std::clamp(std::ceil(4.0 * whole / smallest_seen * (1.0 - nudge)), 16.0, 1024.0));
    CellCount count{{0.0}, {0.0}, true};
    double previous = size(a), smallest = previous, largest = previous;
    for (int k = 1; k <= n_samples; ++k) {
        count.t.push_back(static_cast<double>(k) / n_samples);
        const double here = size(along(a, b, count.t[k]));
        count.cells.push_back(count.cells[k - 1] +
                              0.5 * (1.0 / previous + 1.0 / here) * whole / n_samples);
        smallest = std::min(smallest, here);
        largest = std::max(largest, here);
        count.is_resolved = count.is_resolved &&
                            std::max(here, previous) <= largest_jump * std::min(here, previous);
        previous = here;
    }
    count.is_uniform = largest - smallest <= 1e-9 * largest;
    return count;
}

} // namespace

std::vector<double> divide_segment(Vec2 a, Vec2 b, const SizeField& size) {
    CellCount count =
        size.follows_other_mesh() ? count_cells(a, b, size) : count_cells_evenly(a, b, size);
    if (!count.is_resolved)
        count = count_cells(a, b, size);
    const double total = count.cells.back();
    const double nudge = size.is_scale_free() ? tie_margin : 0.0;
    const int n = std::max(1, static_cast<int>(std::lround(total * (1.0 + nudge))));
    std::vector<double> t(n + 1);
    std::size_t k = 0;
    for (int i = 0; i <= n; ++i) {
        t[i] = static_cast<double>(i) / n;
        if (count.is_uniform || i == 0 || i == n)
            continue;
        const double wanted = t[i] * total;
        while (count.cells[k + 1] < wanted)
            ++k;
        const double share = (wanted - count.cells[k]) / (count.cells[k + 1] - count.cells[k]);
        t[i] = count.is_even
                   ? (static_cast<double>(k) + share) / static_cast<double>(count.t.size() - 1)
                   : count.t[k] + share * (count.t[k + 1] - count.t[k]);
    }
    return t;
}

} // namespace cpp_mesh
