!> Laws of the fluid: densities, potentials and viscosities in closed form, derivatives by
!! differences, tables, and scenes whose laws are refused.
program test_scene_fluid
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use scene_fluid_law, only: fluid_law_t, has_law, new_fluid_law, viscosity_ratio
   use scene_namelist, only: read_scene
   use scene_test_files, only: delete_file, put_changed, put_lines
   use scene_types, only: fluid_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_fluid.nml"
   character(len=*), parameter :: doc = " (see docs/input.md)"
   !&<
   character(len=100), parameter :: good(*) = [character(len=100) :: &
      "&scene name='laws' /", &  ! 1
      "&domain x_min=0.0 x_max=2.0 y_min=0.0 y_max=1.0 /", &  ! 2
      "&material young=40.0e9 poisson=0.2 biot=0.8 porosity=0.01 permeability=5.0e-20 /", &  ! 3
      "&fluid compressibility=4.0e-10 viscosity=1.0e-3", &  ! 4
      "  viscosity_law='table' density_law='table' reference_pressure=1.0e7", &  ! 5
      "  table_pressure=0.0, 1.0e7, 5.0e7", &  ! 6
      "  table_viscosity=0.9e-3, 1.0e-3, 2.0e-3", &  ! 7
      "  table_density=1000.0, 1004.0, 1018.0", &  ! 8
      "/", &  ! 9
      "&fracture name='f1' x=0.9, 1.1 y=0.5, 0.6 friction=0.5 aperture=1.0e-3 /", &  ! 10
      "&side name='left' x_displacement=0.0 /", &  ! 11
      "&side name='bottom' y_displacement=0.0 /", &  ! 12
      "&time end=3600.0 step=60.0 /", &  ! 13
      "&coarse size_fracture=0.01 size_boundary=0.1 /"]  ! 14
   !&>
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(error_t), allocatable :: error

   call test_exponential()
   call test_table()
   call test_extremes()
   call test_read()
   call test_refused()
   call delete_file(path)
   call checks%finish()

contains

   !> Both laws exponential: the potential is (exp((c - beta) (p - p_0)) - 1)/(c - beta).
   subroutine test_exponential()
      type(fluid_t) :: fluid
      type(fluid_law_t) :: law
      real(rk), parameter :: pressures(5) = [-4.0e7_rk, 0.0_rk, 9.9e6_rk, 1.0e7_rk, 8.0e7_rk]
      ! The second is nearly that of the density.
      real(rk), parameter :: exponents(3) = [2.0e-8_rk, 5.0e-9_rk*(1.0_rk + 1.0e-9_rk), -3.0e-8_rk]
      real(rk) :: density, exact, potential, rate, slope
      integer(ik) :: i, k

      call checks%is_true(.not. has_law(fluid), "no law by itself")
      fluid%viscosity = 2.0e-3_rk
      fluid%compressibility = 5.0e-9_rk
      fluid%viscosity_law = "exponential"
      fluid%density_law = "exponential"
      fluid%reference_pressure = 1.0e7_rk
      do k = 1, 3
         fluid%viscosity_exponent = exponents(k)
         law = new_fluid_law(fluid)
         call checks%is_true(has_law(fluid), "a law")
         rate = fluid%compressibility - fluid%viscosity_exponent
         do i = 1, size(pressures)
            associate (d => pressures(i) - fluid%reference_pressure)
               call law%density_at(pressures(i), density, slope)
               exact = exp(fluid%compressibility*d)
               call checks%is_close(density, exact, 1.0e-13_rk*exact, "density")
               call checks%is_close(slope, fluid%compressibility*exact, 1.0e-20_rk, &
                                    "slope of the density")
               call law%potential_at(pressures(i), potential, slope)
               ! A series where the rates all but cancel.
               exact = d*(1.0_rk + 0.5_rk*rate*d)
               if (k /= 2) exact = (exp(rate*d) - 1.0_rk)/rate
               call checks%is_close(potential, exact, 1.0e-5_rk, "potential")
               exact = exp(rate*d)
               call checks%is_close(slope, exact, 1.0e-12_rk*exact, "its slope")
               call checks%is_close(law%thickness_at(pressures(i))*exact, 1.0_rk, 1.0e-12_rk, &
                                    "thickness")
               call checks%is_close(law%thickness_slope(pressures(i)), -rate/exact, 1.0e-19_rk, &
                                    "slope of the thickness")
            end associate
         end do
      end do
   end subroutine test_exponential

   !> Places of a table have their values, between them the mean is the geometric one, beyond them
   !! all is constant; the potential is the integral of its slope.
   subroutine test_table()
      type(fluid_t) :: fluid
      type(fluid_law_t) :: law
      real(rk), parameter :: step = 1.0e3_rk
      real(rk) :: above, below, density, mobility, p, slope, unused
      integer(ik) :: i

      fluid%viscosity = 1.0e-3_rk
      fluid%compressibility = 4.0e-10_rk
      fluid%viscosity_law = "table"
      fluid%density_law = "table"
      fluid%reference_pressure = 1.0e7_rk
      fluid%table_pressure = [0.0_rk, 1.0e7_rk, 5.0e7_rk]
      fluid%table_viscosity = [0.9e-3_rk, 1.0e-3_rk, 2.0e-3_rk]
      fluid%table_density = [1.0e3_rk, 1.004e3_rk, 1.018e3_rk]
      law = new_fluid_law(fluid)
      call law%density_at(5.0e7_rk, density, slope)
      call checks%is_close(density, 1018.0_rk/1004.0_rk, 1.0e-14_rk, "density at a place")
      call law%density_at(3.0e7_rk, density, slope)
      call checks%is_close(density, sqrt(1018.0_rk/1004.0_rk), 1.0e-14_rk, "between two")
      call law%density_at(9.0e7_rk, density, slope)
      call checks%is_close(density, 1018.0_rk/1004.0_rk, 1.0e-14_rk, "density beyond")
      call checks%is_close(slope, 0.0_rk, 1.0e-30_rk, "which is constant")
      call law%density_at(-1.0e6_rk, density, slope)
      call checks%is_close(density, 1000.0_rk/1004.0_rk, 1.0e-14_rk, "density before")
      call checks%is_close(law%thickness_at(0.0_rk), 0.9_rk*1.004_rk, 1.0e-13_rk, "thickness")
      call checks%is_close(law%thickness_at(-1.0_rk), 0.9_rk*1.004_rk, 1.0e-13_rk, "beyond")
      call law%potential_at(1.0e7_rk, above, mobility)
      call checks%is_close(above, 0.0_rk, 1.0e-8_rk, "no potential at the reference pressure")
      call checks%is_close(mobility, 1.0_rk, 1.0e-13_rk, "nor another mobility")
      fluid%table_temperature = [300.0_rk, 400.0_rk, 450.0_rk]
      fluid%viscosity_at = [2.0e-3_rk, 1.0e-3_rk, 0.5e-3_rk]
      call checks%is_close(viscosity_ratio(fluid, 350.0_rk), sqrt(2.0_rk), 1.0e-14_rk, &
                           "viscosity between two temperatures")
      call checks%is_close(viscosity_ratio(fluid, 500.0_rk), 0.5_rk, 1.0e-14_rk, "and beyond them")
      do i = -2, 14
         p = 4.1e6_rk*i + 1.0e5_rk
         call law%potential_at(p + step, above, unused)
         call law%potential_at(p - step, below, unused)
         call law%potential_at(p, unused, mobility)
         call checks%is_close((above - below)/(2.0_rk*step), mobility, 1.0e-9_rk, &
                              "the potential rises by the mobility")
      end do
   end subroutine test_table

   !> Whatever an iteration tries, numbers are finite and the potential does not fall.
   subroutine test_extremes()
      type(fluid_t) :: fluid
      type(fluid_law_t) :: law
      real(rk) :: before, density, p, potential, slope
      integer(ik) :: i, k

      fluid%viscosity = 1.0e-3_rk
      fluid%compressibility = 1.0e-6_rk
      fluid%viscosity_law = "exponential"
      fluid%density_law = "exponential"
      fluid%reference_pressure = 1.0e7_rk
      do k = 1, 2
         fluid%viscosity_exponent = 1.0e-6_rk*(3 - 2*k)
         law = new_fluid_law(fluid)
         before = -huge(1.0_rk)
         do i = -40, 40
            p = sign(10.0_rk**(0.4_rk*abs(i)), real(i, rk))
            call law%density_at(p, density, slope)
            call law%potential_at(p, potential, slope)
            call checks%is_true(density > 0.0_rk .and. density < 1.0e30_rk, "a density")
            call checks%is_true(potential >= before .and. slope > 0.0_rk .and. &
                                abs(potential) < 1.0e60_rk, "a potential that rises")
            before = potential
         end do
      end do
   end subroutine test_extremes

   !> The scene without a fault, and the reference pressure that follows from others.
   subroutine test_read()
      call put_lines(path, good)
      call read_scene(path, scene, error)
      call checks%no_error(error, "the scene without a fault")
      if (allocated(error)) return
      call checks%is_true(size(scene%fluid%table_pressure) == 3, "pressures of the table")
      call put_lines(path, [character(len=100) :: good(:4), &
                            "  viscosity_law='exponential' viscosity_exponent=1e-8", good(9:), &
                            "&initial pressure=2.0e6 /"])
      call read_scene(path, scene, error)
      call checks%no_error(error, "an exponential law")
      call checks%is_close(scene%fluid%reference_pressure, 2.0e6_rk, 0.0_rk, "initial pressure")
   end subroutine test_read

   subroutine test_refused()
      call refuse(5, "  viscosity_law='table' density_law='tables'", &
                  ":5: &fluid: density_law is "// &
                  "'tables' but must be 'linear', 'exponential' or 'table'"//doc)
      call refuse(6, "", &
                  ":4: &fluid: table_pressure is missing but must be given with a table"//doc)
      call refuse(6, "  table_pressure=1.0e7", &
                  ":6: &fluid: table_pressure has 1 value but must "// &
                  "have at least two"//doc)
      call refuse(6, "  table_pressure=0.0, 1.0e7, 1.0e7", &
                  ":6: &fluid: table_pressure must increase, but does not from 1.0e7 to 1.0e7"//doc)
      call refuse(6, "  table_pressure=2.0e7, 3.0e7, 5.0e7", &
                  ":6: &fluid: table_pressure reaches from 2.0e7 to 5.0e7 but must contain "// &
                  "the reference_pressure, 1.0e7"//doc)
      call refuse(7, "  table_viscosity=1.0e-3, 2.0e-3", ":7: &fluid: table_viscosity has 2 "// &
                  "values but must have one for each table_pressure, 3"//doc)
      call refuse(7, "  table_viscosity=1.0e-3, 0.0, 2.0e-3", ":7: &fluid: table_viscosity is "// &
                  "0.0 but must be a finite number greater than 0.0 [Pa s]"//doc)
      call refuse(7, "  table_viscosity=1.0e-3, 1.1e-3, 2.0e-3", &
                  ":4: &fluid: viscosity is 0.001 "// &
                  "but must be that of the table at reference_pressure, 0.0011, which the rock "// &
                  "takes"//doc)
      call refuse(7, "", ":4: &fluid: table_viscosity [Pa s], which the "// &
                  "viscosity_law 'table' needs, is missing"//doc)
      call refuse(7, "  table_viscosity=0.9e-3, 1.0e-3, 2.0e-3 viscosity_exponent=1e-8", &
                  ":7: &fluid: viscosity_exponent is given, but only the viscosity_law "// &
                  "'exponential' has it, and not 'table'"//doc)
      call refuse(8, "  table_density=1000.0, 1004.0, 1003.0", ":8: &fluid: table_density "// &
                  "must not decrease, but does from 1004.0 to 1003.0"//doc)
      call refuse(8, "  table_density=1000.0, 1008.0, 1038.0", ":4: &fluid: compressibility is "// &
                  "4.0e-10 but must be that of the table at reference_pressure, 7.65e-10, "// &
                  "which "// &
                  "the rock takes"//doc)
      call refuse(5, "  viscosity_law='table' density_law='linear' reference_pressure=1.0e7", &
                  ":8: &fluid: table_density is given, but only the density_law 'table' has "// &
                  "it, "// &
                  "and not 'linear'"//doc)
      call refuse_all([character(len=100) :: good(:3), &
                       "&fluid compressibility=4.0e-10 viscosity=1.0e-3 reference_pressure=1.0 /", &
                       good(10:)], ":4: &fluid: reference_pressure is given, but neither "// &
                      "viscosity_law nor density_law depends on it; omit it"//doc)
      call refuse_all([character(len=100) :: good(:3), &
                       "&fluid compressibility=4e-10 viscosity=1e-3 table_pressure=0.0, 1.0 /", &
                       good(10:)], ":4: &fluid: table_pressure is given, but neither "// &
                      "viscosity_law nor density_law is 'table'"//doc)
      call refuse_all([character(len=100) :: good(:3), &
                       "&fluid compressibility=0.0 viscosity=1.0e-3 density_law='exponential' /", &
                       good(10:)], ":4: &fluid: density_law is 'exponential', which takes a "// &
                      "compressibility that is positive, and not 0.0"//doc)
      call refuse_all([character(len=100) :: good(:3), &
                       "&fluid compressibility=1e-10 viscosity=1e-3 viscosity_law='exponential'", &
                       "viscosity_exponent=2e-6 /", good(10:)], &
                      ":5: &fluid: viscosity_exponent is 2e-6 but must be a finite number at "// &
                      "least -1.0e-6 and at most 1.0e-6 [1/Pa]"//doc)
   end subroutine test_refused

   subroutine refuse(line, changed, message)
      integer, intent(in) :: line
      character(len=*), intent(in) :: changed, message

      call put_changed(path, good, line, changed, line, changed)
      call compare(message)
   end subroutine refuse

   subroutine refuse_all(lines, message)
      character(len=*), intent(in) :: lines(:), message

      call put_lines(path, lines)
      call compare(message)
   end subroutine refuse_all

   subroutine compare(message)
      character(len=*), intent(in) :: message

      call read_scene(path, scene, error)
      call checks%fails_by(error, path//message)
   end subroutine compare

end program test_scene_fluid
