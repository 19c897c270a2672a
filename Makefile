# A thin front: CMake with presets does the work (see CMakePresets.json).
#   make run [SCENE=configs/quickstart.yaml] [OUT=runs/...]   install, build, run a scene
#   make test                                                 install, build, run every test
SCENE ?= configs/quickstart.yaml
OUT   ?=

.PHONY: run test build packages test_packages lint tidy asan clean

build: packages
	@cmake --preset release
	@cmake --build --preset release --target coordinator cfd_server dem_server

run: build
	./build/release/bin/coordinator run $(SCENE) $(if $(OUT),--out $(OUT))

# The sanitised suite first, the release suite (all tests) last: its summary closes the run.
test: test_packages lint asan
	cmake --preset release
	cmake --build --preset release
	ctest --preset release

asan:
	cmake --preset asan
	cmake --build --preset asan
	ctest --preset asan

lint: packages
	./tests/tools/check_format.sh

tidy: test_packages
	cmake --preset tidy
	./tests/tools/check_tidy.sh build/tidy

packages:
	@./tests/tools/install_packages.sh build

test_packages:
	@./tests/tools/install_packages.sh build test

clean:
	rm -rf build
