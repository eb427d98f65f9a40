// Decimal digits of numbers, by the standard library; used by base_number.f90 alone.
#include <charconv>
#include <cstring>

namespace {
constexpr int most_digits = 17; // that any double may need to be told from its neighbours
constexpr int most_characters = most_digits + 8; // with a point, and an exponent as e-308
} // namespace

// Digits of x >= 0, finite: x = d.ddd * 10^power. Those that read back as x, as few and as close to
// it as possible, if n_digits is 0; else so many, from 1 to 17, exact ties to the even digit.
// Zeros at the end are left out; blanks follow.
extern "C" void base_number_digits(double x, int n_digits, char digits[most_digits],
                                   int* power) noexcept {
    char text[most_characters];
    const auto format = std::chars_format::scientific;
    char* const end = text + most_characters;
    const char* const last = (n_digits == 0 ? std::to_chars(text, end, x, format)
                                            : std::to_chars(text, end, x, format, n_digits - 1))
                                 .ptr;

    int n = 0;
    const char* at = text;
    for (; *at != 'e'; ++at) {
        if (*at != '.') {
            digits[n++] = *at;
        }
    }
    while (n > 1 && digits[n - 1] == '0') {
        --n;
    }
    std::memset(digits + n, ' ', most_digits - n);
    const bool is_small = at[1] == '-';
    std::from_chars(at + 2, last, *power); // which knows no plus sign
    if (is_small) {
        *power = -*power;
    }
}
