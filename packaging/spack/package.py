# Recipe for Spack: put this file into packages/wingcrack/package.py of a repository of your own
# (`spack repo create`). Written after Spack's documentation; not tried.
#
# The sources are taken from a folder: spack dev-build wingcrack@0.2.0 in the folder of the sources.

from spack.package import CMakePackage, depends_on, generator, license, version


class Wingcrack(CMakePackage):
    """Fluid-driven slip, opening and growth of fractures in poroelastic rock, in two dimensions."""

    license("GPL-3.0-or-later")

    version("0.2.0")

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("fortran", type="build")
    depends_on("cmake@3.22:", type="build")
    depends_on("ninja", type="build")
    depends_on("mumps~mpi+metis+openmp")
    depends_on("metis@5:")
    depends_on("suite-sparse")
    depends_on("gmsh@4.11:+shared")
    depends_on("blas")
    depends_on("lapack")
    depends_on("python@3.11:", type=("build", "run"))
    depends_on("py-numpy@2:", type="run")
    depends_on("py-matplotlib@3.9:", type="run")
    depends_on("py-pandas", type="run")
    depends_on("py-click@8.1:", type="run")
    depends_on("py-f90nml", type="run")

    generator("ninja")

    def cmake_args(self):
        """Let the compiler's flags of the target be Spack's."""
        return [
            self.define("WINGCRACK_PROCESSOR", ""),
            self.define("Gmsh_ROOT", self.spec["gmsh"].prefix),
        ]

    def setup_run_environment(self, env):
        """Name the Python that has the packages."""
        env.set("WINGCRACK_PYTHON", self.spec["python"].command.path)
