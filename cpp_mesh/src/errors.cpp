#include "errors.hpp"

#include <array>
#include <charconv>

namespace cpp_mesh {

namespace {

std::string number_of(Culprit culprit) {
    return std::to_string(culprit.number + 1);
}

std::string kind_name(CulpritKind kind) {
    switch (kind) {
    case CulpritKind::corner:
        return "corner";
    case CulpritKind::edge:
        return "edge";
    case CulpritKind::fixed_point:
        return "fixed point";
    default:
        return "fracture";
    }
}

std::string of_boundary(CulpritKind kind) {
    return kind == CulpritKind::corner || kind == CulpritKind::edge ? " of the boundary" : "";
}

std::string name_of(Culprit culprit) {
    return kind_name(culprit.kind) + " " + number_of(culprit) + of_boundary(culprit.kind);
}

void replace(std::string& text, const std::string& mark, const std::string& words) {
    const std::size_t at = text.find(mark);
    if (at != std::string::npos)
        text.replace(at, mark.size(), words);
}

std::string text_of(double value, int digits) {
    std::array<char, 32> text; // sign, digits, point and exponent need 17 of them
    const auto written = std::to_chars(text.data(), text.data() + text.size(), value,
                                       std::chars_format::general, digits);
    return {text.data(), written.ptr};
}

// Of large coordinates, as those of maps, the first digits are alike.
std::string coordinate_text(double value) {
    return text_of(value, std::abs(value) < 1e4 ? 6 : 10);
}

Fault with_place(Fault fault) {
    if (fault.place)
        replace(fault.reason, "{at}",
                "at (" + coordinate_text(fault.place->x) + ", " + coordinate_text(fault.place->y) +
                    ")");
    return fault;
}

// The reason with the culprits by their numbers.
std::string message_of(const Fault& fault) {
    std::string text = fault.reason;
    const std::vector<Culprit>& who = fault.culprits;
    if (who.size() == 2 && who[0].kind == who[1].kind)
        replace(text, "{1} and {2}",
                kind_name(who[0].kind) + "s " + number_of(who[0]) + " and " + number_of(who[1]) +
                    of_boundary(who[0].kind));
    for (std::size_t k = 0; k < who.size(); ++k)
        replace(text, "{" + std::to_string(k + 1) + "}", name_of(who[k]));
    return text;
}

} // namespace

MeshError::MeshError(Fault fault)
    : std::runtime_error(message_of(with_place(fault))), fault_(with_place(std::move(fault))) {}

std::string number_text(double value) {
    return text_of(value, 6);
}

} // namespace cpp_mesh
