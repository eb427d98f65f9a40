#include "errors.hpp"

#include <sstream>

namespace cpp_mesh {

std::string number_text(double value) {
    std::ostringstream text;
    text.precision(6);
    text << value;
    return text.str();
}

} // namespace cpp_mesh
