#!/usr/bin/env python3
"""The layer check itself: each kind of mistake is found in a small tree made for it, and a right tree passes."""
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "..", "tools"))
import check_layers  # noqa: E402

RIGHT = {
    "tools/layers.txt": "base:\ngpu: base\napp: base gpu\n",
    "tools/outside_headers.txt": "vulkan/*: gpu/*\n",
    "base/a.h": "#pragma once\n#include <vector>\n",
    "gpu/b.h": '#include "base/a.h"\n#include <vulkan/vulkan.h>\n',
    "gpu/c.comp": "#version 450\n",
    "gpu/c.cpp": '#include "gpu/c.comp.h"\n',
    "gpu/CMakeLists.txt": "entoptic_room(gpu ROOMS base LIBRARIES Vulkan::Vulkan)\n",
    "app/d.cpp": '#include "gpu/b.h"\n',
}


class CheckLayers(unittest.TestCase):
    def problems(self, changes=None):
        with tempfile.TemporaryDirectory() as root:
            for path, text in {**RIGHT, **(changes or {})}.items():
                os.makedirs(os.path.dirname(os.path.join(root, path)), exist_ok=True)
                with open(os.path.join(root, path), "w", encoding="utf-8") as file:
                    file.write(text)
            return check_layers.check(root)

    def assert_one(self, problems, part):
        self.assertEqual(len(problems), 1, problems)
        self.assertIn(part, problems[0])

    def test_right_tree_passes(self):
        self.assertEqual(self.problems(), [])

    def test_upward_include(self):
        self.assert_one(self.problems({"base/a.h": '#include "gpu/e.h"\n', "gpu/e.h": ""}), "base/a.h:1: base/ may not include gpu/")

    def test_include_without_room(self):
        self.assert_one(self.problems({"app/d.cpp": '#include "b.h"\n'}), "does not name a room")

    def test_missing_file(self):
        self.assert_one(self.problems({"app/d.cpp": '#include "gpu/x.h"\n'}), "is not there")

    def test_cycle_of_files(self):
        self.assert_one(self.problems({"base/a.h": '#include "base/e.h"\n', "base/e.h": '#include "base/a.h"\n'}), "files include each other")

    def test_cycle_of_rooms(self):
        problems = self.problems({"tools/layers.txt": "base: app\ngpu: base\napp: base gpu\n"})
        self.assert_one(problems, "rooms form a cycle")

    def test_outside_header(self):
        self.assert_one(self.problems({"app/d.cpp": "#include <vulkan/vulkan.h>\n"}), "does not belong here")

    def test_room_linked_but_not_allowed(self):
        self.assert_one(self.problems({"gpu/CMakeLists.txt": "entoptic_room(gpu ROOMS base app)\n"}), "gpu may not link app")


if __name__ == "__main__":
    unittest.main()
