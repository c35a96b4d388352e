# What the baker's library is made with. The Python package includes this, too, where it takes the library from a build of
# the tree.
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(OpenMesh REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(Threads REQUIRED)
find_package(ZLIB REQUIRED)
find_package(draco REQUIRED)
find_package(meshoptimizer REQUIRED)
