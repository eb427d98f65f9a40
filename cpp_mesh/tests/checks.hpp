// Named checks that count failures; a test program returns finish().
#ifndef CPP_MESH_CHECKS_HPP
#define CPP_MESH_CHECKS_HPP

#include <cmath>
#include <cstdio>
#include <string>

class Checks {
public:
    void is_true(bool condition, const std::string& name) {
        if (condition) {
            ++passed_;
        } else {
            ++failed_;
            std::fprintf(stderr, "FAILED: %s\n", name.c_str());
        }
    }

    // |value - expected| <= tolerance; a NaN fails.
    void is_close(double value, double expected, double tolerance, const std::string& name) {
        char numbers[120];
        std::snprintf(numbers, sizeof numbers, ": %.16g is not %.16g within %.3g", value, expected,
                      tolerance);
        is_true(std::abs(value - expected) <= tolerance, name + numbers);
    }

    void is_equal(long value, long expected, const std::string& name) {
        is_true(value == expected,
                name + ": " + std::to_string(value) + " is not " + std::to_string(expected));
    }

    // The text contains the words.
    void says(const std::string& text, const std::string& words, const std::string& name) {
        is_true(text.find(words) != std::string::npos, name + ": \"" + text + "\"");
    }

    int finish() const {
        std::printf("%d passed, %d failed\n", passed_, failed_);
        return failed_ > 0 || passed_ == 0 ? 1 : 0;
    }

private:
    int passed_ = 0;
    int failed_ = 0;
};

#endif
