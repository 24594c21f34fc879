#!/usr/bin/env python3
"""tools/structure.py counts what a reader would count: lines of functions, members of classes, headers behind a header."""
import pathlib
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tools"))
import structure  # noqa: E402


def scanned(text):
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "code.hpp"
        path.write_text(text)
        functions, classes = structure.scan(path)
    return {name: size for size, name, _ in functions}, {name: (size, kind) for size, name, _, kind in classes}


class Functions(unittest.TestCase):
    def test_lines_from_the_first_of_the_declaration_to_the_closing_brace(self):
        functions, _ = scanned("""namespace a {
int one() { return 1; }
std::map<int, std::vector<double>> Some::two(
    const std::string& text) const {
  if (text == "}") return {};
  auto f = [&](int k) { return k < '{' ? k : 2; };
  return {{1, {2.0}}};
}
}  // namespace a
""")
        self.assertEqual(functions, {"one": 1, "Some::two": 6})

    def test_a_constructor_with_braces_in_its_list(self):
        functions, _ = scanned("""Some::Some(const Options& o) : a_{o.a}, b_(o.b), c_{1, 2} {
  go();
}
Some::Some() noexcept
    : Base<int>{1},
      d_{2} {
}
auto turned(double x) -> Pose {
  return x;
}
bool operator==(const Some& a, const Some& b) {
  return true;
}
""")
        self.assertEqual(functions, {"Some::Some": 4, "turned": 3, "operator==": 3})

    def test_comments_macros_and_raw_strings_are_no_code(self):
        functions, _ = scanned("""#define TWICE(x) \\
  { x; x; }
/* void gone() { */
const char* kText = R"(void neither() {)";
int f() {  // {
  return 1'000;
}
""")
        self.assertEqual(functions, {"f": 3})


class Members(unittest.TestCase):
    def test_what_is_a_member_and_what_is_not(self):
        _, classes = scanned("""class Some : public Base {
 public:
  explicit Some(int a = 3);
  Some& operator=(const Some&) = default;
  int size() const { return static_cast<int>(a_.size()); }
  static constexpr double kHalf = 0.5;
  using Key = int;
  friend class Other;
  enum class Kind { kOne, kTwo };
  struct Inner {
    int x = 0, y = 0;
    double z{1.0};
  };
  template <typename T>
  void put(T t);

 private:
  std::vector<std::pair<int, double>> a_;
  std::function<void(int, int)> call_ = [](int, int) {};
  double b_[3] = {1, 2, 3};
  int c_ = f(1, 2), d_;
  std::optional<Inner> e_{};
};
""")
        self.assertEqual(classes, {"Some": (6, "class"), "Inner": (3, "struct")})


class Behind(unittest.TestCase):
    def test_each_header_once_however_it_is_reached(self):
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder).resolve()
            for name, text in {"include/phasescan/a.hpp": '#include <vector>\n#include "phasescan/b.hpp"\n#include "in/c.hpp"\n',
                               "include/phasescan/b.hpp": '#include "in/c.hpp"\n#include "phasescan/a.hpp"\n', "src/in/c.hpp": ""}.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_text(text)
            found = structure.behind(root, root / "include/phasescan/a.hpp")
            self.assertEqual({p.name for p in found}, {"b.hpp", "c.hpp"})


if __name__ == "__main__":
    unittest.main()
