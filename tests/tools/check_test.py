"""Tests that check.py finds what is wrong in a small repository, and nothing else."""

import os
import tempfile
import unittest

import check

DOCUMENTS = {
    "a.md": "# One `two`: three\n# One two three\n[b](b/c.md#x-y) [a](#one-two-three-1) [o](http://x/y) [f](b)\n"
            "[no](no.md) [no](b/c.md#no) `[code](no.md)`\n```\n[code](no.md)\n```\n[![no](no.svg)](a.md)\n[r]: no.txt\n",
    "b/c.md": "## x y\n[up](../a.md#one-two-three) [out](../../a.md)\n<img src=\"no.png\">\n",
    "core/rules.md": "## 1. Owned things\n",
    "core/experiments.md": "## Tried things\n### Fast ones\n",
    "core/x.h": "/// Source: rules.md, Owned\n/// things; rules.md, No such rule.\n"
                "// See experiments.md, Fast\n// ones. See experiments.md, Slow ones.\n",
}
CLASSES = {
    "core/a.h": """
/// A comment with a brace { in it.
class Outer : public Base<int, 2> {
 public:
  explicit Outer(int a) : a_(a), b_{a} {}
  struct Inner {
    int x = 0, y = 0;
    std::function<void(int)> call;
  };
  enum class Kind { kOne, kTwo };
  int f() const;
  bool operator<(const Outer& other) const { return a_ < other.a_; }
  template <class T>
  void g(T t) {
    int local;
  }

 private:
  struct Hidden;
  static constexpr int kNone = 0;
  friend class Other;
  using Map = std::map<int, Inner>;
  int a_, b_;
  std::map<int, std::pair<int, int>> c_;
  std::vector<int> d_ = {1, 2}, e_{3};
  const char* text_ = "(};";
};
""",
    "core/a.cpp": """
struct Outer::Hidden {
  int h;
};
namespace {
int Outer::f() const {
  return 0;
}
int free(int a) { return a; }
}
""",
}
ENGLISH = """
/// What it is.
constexpr int kMostThings = 1;  ///< of both
// Without a clause.
// With a clause, it is one.
TEST(Suite, name) {}
"""


class CheckTest(unittest.TestCase):
    def repository(self, texts):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        for path, text in texts.items():
            os.makedirs(os.path.dirname(os.path.join(folder.name, path)), exist_ok=True)
            with open(os.path.join(folder.name, path), "w", encoding="utf-8") as file:
                file.write(text)
        return folder.name

    def test_broken_links_and_citations_are_found(self):
        self.assertEqual(sorted(check.link_faults(self.repository(DOCUMENTS))), [
            "a.md:4: b/c.md has no heading for #no", "a.md:4: there is no no.md", "a.md:8: there is no no.svg",
            "a.md:9: there is no no.txt", "b/c.md:2: ../../a.md leaves the repository", "b/c.md:3: there is no b/no.png",
            "core/x.h: core/experiments.md has no experiment \"Slow ones\"",
            "core/x.h: core/rules.md has no rule \"No such rule\""])

    def test_classes_are_counted_as_a_reader_would(self):
        found = {each.name: (each.members, each.lines) for each in check.find_classes(self.repository(CLASSES))}
        self.assertEqual(found, {"Outer": (6, 25 + 3), "Outer::Inner": (3, 4), "Outer::Hidden": (1, 3)})

    def test_a_class_may_be_large_if_its_comment_says_why(self):
        members = "".join(f"  int m{i}_;\n" for i in range(check.MAX_MEMBERS + 1))
        text = f"class Many {{\n{members}}};\n/// A class.\n/// {check.EXCUSE}it must be.\nclass Excused {{\n{members}}};\n"
        faults = list(check.class_faults(self.repository({"core/b.h": text})))
        self.assertEqual(len(faults), 1)
        self.assertIn("Many has 16 data members and 18 lines", faults[0])

    def test_what_is_not_plain_english_is_found(self):
        lines = [fault.split(":")[1] for fault in check.english_faults(self.repository({"core/e.h": ENGLISH}))]
        self.assertEqual(sorted(lines), ["2", "3", "3", "4", "6"])

    def test_includes_that_go_up_and_words_across_a_seam_are_found(self):
        root = self.repository({"core/base/a.h": '#include "core/mesh/b.h"\nFrame f;  // Frame\n', "core/mesh/b.h": ""})
        self.assertEqual([fault.split(": ")[0] for fault in check.include_faults(root)],
                         ["core/base/a.h:1", "core/base/a.h:2"])

    def test_rooms_that_include_each_other_and_long_chains_are_found(self):
        # Two ways around lead through b: they are one circle.
        root = self.repository({
            "core/a.h": '#include "core/b.h"\n', "core/b.h": '#include "core/c.h"\n', "core/c.h": "",
            "core/b.cpp": '#include "core/b.h"\n#include "core/a.h"\n#include "core/d.h"\n',
            "core/c.cpp": '#include "core/c.h"\n', "core/d.h": '#include "core/b.h"\n'})
        self.assertEqual(check.include_shape(root),
                         ([["core/a", "core/b", "core/d"]], ["core/b.cpp", "core/a.h", "core/b.h", "core/c.h"]))


if __name__ == "__main__":
    unittest.main()
