#include "size_tree.hpp"

#include <numeric>

namespace cpp_mesh {

namespace {

constexpr int largest_leaf = 4;

} // namespace

SizeTree::SizeTree(const std::vector<Bound>& items) : order_(items.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    if (!items.empty())
        grow(items, 0, size());
}

void SizeTree::grow(const std::vector<Bound>& items, int first, int last) {
    Bound all = items[order_[first]];
    for (int k = first + 1; k < last; ++k) {
        const Bound& item = items[order_[k]];
        all.low = {std::min(all.low.x, item.low.x), std::min(all.low.y, item.low.y)};
        all.high = {std::max(all.high.x, item.high.x), std::max(all.high.y, item.high.y)};
        all.size = std::min(all.size, item.size);
        all.slope = std::min(all.slope, item.slope);
        all.radius = std::max(all.radius, item.radius);
    }
    const std::size_t number = branches_.size();
    branches_.push_back({all, first, last});
    if (last - first <= largest_leaf)
        return;
    const bool is_wide = all.high.x - all.low.x > all.high.y - all.low.y;
    const int middle = (first + last) / 2;
    std::nth_element(
        order_.begin() + first, order_.begin() + middle, order_.begin() + last, [&](int i, int j) {
            const Vec2 a = items[i].low + items[i].high, b = items[j].low + items[j].high;
            return is_wide ? a.x < b.x : a.y < b.y;
        });
    grow(items, first, middle);
    branches_[number].right = static_cast<int>(branches_.size());
    grow(items, middle, last);
}

} // namespace cpp_mesh
