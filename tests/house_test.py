# SPDX-License-Identifier: MIT
"""Does house.py notice? Small trees in which one rule is broken, and functions whose lengths are known."""

import os
import sys
import tempfile
import unittest

from functions import c_functions, javascript_functions, python_functions
from house import (Tree, backward_arrows, dots_and_crosses, forbidden_includes, long_files, lost_mutations, read_mutations, unbroken_folders,
                   unnamed_files)

ORDER = "| `base/` | x |\n| `geometry/` | x |\n| `mesh/` | x |\n| `solver/` | x |\n"

C = """// a comment with a brace {
#define BRACE {
static const char text[] = "}{", list[] = { 1, 2 };
struct pair { int (*f)(void); };
__attribute__((visibility("default"))) struct pair *first(int a) {
    if (a) { return 0; }
    return 0;
}
namespace {
class Box {
    int two() const {
        return 2;
    }
};
}
int third(const int v[3],
          int w) { return v[w]; }
"""

JAVASCRIPT = "export async function one(a, { b } = {}) {\n    if (a) {\n    }\n}\nclass X {\n    two() {\n    }\n}\n"


class House(unittest.TestCase):
    def tree(self, **files):
        """A tree of sources; a name is a path in which '__' stands for '/' and '_dot_' for '.'."""
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        files.setdefault("plugin__core__README_dot_md", ORDER)
        for name, text in files.items():
            path = os.path.join(folder.name, name.replace("__", "/").replace("_dot_", "."))
            os.makedirs(os.path.dirname(path), exist_ok=True)
            with open(path, "w", encoding="utf-8") as f:
                f.write(text)
        return Tree(folder.name)

    def test_an_arrow_backwards_is_found_and_one_forwards_is_none(self):
        tree = self.tree(plugin__core__mesh__mesh_dot_h='#include "solver/b.h"\n', plugin__core__solver__b_dot_h='#include "mesh/mesh.h"\n')
        self.assertEqual([(path, line) for path, line, _ in backward_arrows(tree)], [("plugin/core/mesh/mesh.h", 1)])

    def test_a_folder_that_no_order_knows_is_found(self):
        self.assertEqual(len(list(backward_arrows(self.tree(plugin__core__misc__a_dot_c="\n")))), 1)

    def test_converters_take_the_mesh_of_core_and_not_its_solver(self):
        tree = self.tree(plugin__core__mesh__mesh_dot_h="", plugin__core__solver__b_dot_h="",
                         converters__tessellate__t_dot_c='#include "mesh/mesh.h"\n#include "solver/b.h"\n',
                         converters__gltf__g_dot_c='#include "mesh/mesh.h"\n')
        self.assertEqual({(path, line) for path, line, _ in forbidden_includes(tree)},
                         {("converters/tessellate/t.c", 2), ("converters/gltf/g.c", 1)})

    def test_core_and_hosts_stay_where_they_belong(self):
        tree = self.tree(plugin__include__hemibake__hemibake_dot_h="", plugin__core__base__a_dot_h="#include <hemibake/hemibake.h>\n",
                         plugin__hosts__cli__b_dot_c='#include <hemibake/hemibake.h>\n#include "base/a.h"\n')
        self.assertEqual({(path, line) for path, line, _ in forbidden_includes(tree)},
                         {("plugin/core/base/a.h", 1), ("plugin/hosts/cli/b.c", 2)})

    def test_a_library_is_included_by_its_shim_alone_and_an_unknown_one_by_none(self):
        tree = self.tree(color__ocio_config_dot_h="#include <OpenColorIO/OpenColorIO.h>\n#include <vector>\n",
                         color__other_dot_cpp="#include <OpenColorIO/OpenColorIO.h>\n", color__third_dot_c="#include <zlib.h>\n#include <math.h>\n")
        self.assertEqual([path for path, _, _ in forbidden_includes(tree)], ["color/other.cpp", "color/third.c"])

    def test_products_are_found_by_name_and_by_what_they_compute(self):
        for body in ("static double plane_dot(int a) {\n}\n", "#define DOT(a, b) 0\n",
                     "void f(void) {\n    n[0] = u[1] * v[2] -\n           u[2] * v[1];\n}\n",
                     "void f(void) {\n    d = a->n[0] * p.b[0] + a->n[1] * p.b[1] + a->n[2] * p.b[2];\n}\n",
                     "void f(void) {\n    d = a.x * b.x + a.y * b.y + a.z * b.z;\n}\n"):
            self.assertEqual(len(dots_and_crosses("a.c", body)), 1, body)

    def test_lengths_and_calls_are_no_products(self):
        body = "int across(void) {\n    l = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];\n    return vec3_dot(a, b); // a[1] * b[2] - a[2] * b[1]\n}\n"
        self.assertEqual(dots_and_crosses("a.c", body), [])

    def test_four_hundred_lines_pass_and_one_more_does_not(self):
        tree = self.tree(color__a_dot_c="\n" * 400, color__b_dot_c="\n" * 401)
        self.assertEqual([path for path, _, _ in long_files(tree)], ["color/b.c"])

    def test_a_file_is_named_by_its_folders_readme_or_the_next_above(self):
        tree = self.tree(color__README_dot_md="`a.c`, `.h`, `deep/b.c`\n", color__a_dot_h="", color__deep__b_dot_c="", color__deep__other_dot_c="")
        self.assertEqual([path for path, _, _ in unnamed_files(tree.root)], ["color/deep/other.c"])

    def test_a_mutation_is_lost_with_its_line_and_a_folder_without_one_is_found(self):
        listed = "name: one\nwhat: x\nold: return 1;\nnew: return 2;\ntest: a\n\nname: two\nwhat: x\nold: return 3;\nnew: return 2;\ntest: a\n"
        tree = self.tree(color__a_dot_c="return 1;\n", converters__vs3__b_dot_c="return 4;\n", tests__mutations_dot_txt=listed)
        found = read_mutations(tree.root)
        self.assertEqual([text.split(":")[0] for _, _, text in lost_mutations(found)], ["two"])
        self.assertEqual([name for name, _, _ in unbroken_folders(tree, found)], ["converters/vs3"])

    def test_functions_are_measured(self):
        self.assertEqual(c_functions(C), [("first", 5, 8), ("two", 11, 13), ("third", 16, 17)])
        self.assertEqual(python_functions("def a():\n    return 1\n"), [("a", 1, 2)])
        self.assertEqual(javascript_functions(JAVASCRIPT), [("one", 1, 4), ("two", 6, 7)])


if __name__ == "__main__":
    sys.exit(unittest.main())
