!> Named values: arithmetic against numbers worked out by hand, and what is refused.
program test_scene_define
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_expression, only: constant_t, evaluate
   use scene_namelist, only: read_scene
   use scene_test_files, only: delete_file, put_lines
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_define.nml"
   character(len=*), parameter :: doc = " (see docs/input.md)"
   !&<
   character(len=100), parameter :: base(*) = [character(len=100) :: &
      "&domain x_min=0.0 x_max='2*half' y_min=0.0 y_max=1.0 /", &
      "&material young='e_modulus' poisson=0.2 /", &
      "&side name='bottom' x_displacement=0.0 y_displacement=0.0 /", &
      "&side name='top' y_traction='-Sigma' /", &
      "&fracture name='f1' x=0.9, 'half + 0.1' y=0.5, 0.6 friction='0.5' /", &
      "&fe size_fracture=0.05 size_boundary=0.2 /"]
   !&>
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(error_t), allocatable :: error

   call check_arithmetic()
   call check_faults()
   call check_scene()
   call check_refusals()
   call delete_file(path)
   call checks%finish()

contains

   subroutine check_arithmetic()
      call expect_value("2", 2.0_rk)
      call expect_value(" 1 + 2*3 - 4/8 ", 6.5_rk)
      call expect_value("2^3^2", 512.0_rk)
      call expect_value("-2^2", -4.0_rk)
      call expect_value("2^-1", 0.5_rk)
      call expect_value("(1 + 2)*(3 - 4)", -3.0_rk)
      call expect_value("8/4/2", 1.0_rk)
      call expect_value("10-4-3", 3.0_rk)
      call expect_value("24.0E3*a", 60.0e6_rk)
      call expect_value("1d-3+2.5e+3", 2500.001_rk)
      call expect_value("A/b_2--1", 1251.0_rk)
      call expect_value("4^0.5", 2.0_rk)
      call expect_value("sqrt(a)/2 + 1", 26.0_rk)
      call expect_value("2*Sind(30) + cosd(60)*tand(45)", 1.5_rk)
      call expect_value("sin(pi/6)^2 + cos(pi/6)^2", 1.0_rk)
      call expect_value("tan(pi/4)*sqrt(sqrt(16))", 2.0_rk)
      call expect_value("-cosd (-(60))", -0.5_rk)
   end subroutine check_arithmetic

   subroutine expect_value(expression, expected)
      character(len=*), intent(in) :: expression
      real(rk), intent(in) :: expected
      character(len=:), allocatable :: fault
      real(rk) :: value

      call evaluate(expression, [constant_t("a", 2500.0_rk), constant_t("b_2", 2.0_rk)], value, &
                    fault)
      call checks%is_true(.not. allocated(fault), expression//" is read")
      call checks%is_close(value, expected, 1.0e-14_rk, expression)
   end subroutine expect_value

   subroutine check_faults()
      call expect_fault("", "it ends where a number or a name is expected")
      call expect_fault("1 +", "it ends where a number or a name is expected")
      call expect_fault("(1", "a bracket is not closed")
      call expect_fault("1)", "')' stands where an operator or the end is expected")
      call expect_fault("2 3", "'3' stands where an operator or the end is expected")
      call expect_fault("*2", "'*' stands where a number or a name is expected")
      call expect_fault("1/0", "it divides by zero")
      call expect_fault("1/(2-2)", "it divides by zero")
      call expect_fault("depth", "there is no value 'depth' of &define before it")
      call expect_fault("sin", "there is no value 'sin' of &define before it")
      call expect_fault("sin(", "it ends where a number or a name is expected")
      call expect_fault("cosd(1", "a bracket is not closed")
      call expect_fault("sqrt(1-2)", "the root of a negative number is none")
      call expect_fault("ln(2)", "there is no function 'ln' (there are sqrt, sin, cos, tan of "// &
                        "radians, and sind, cosd, tand of degrees)")
      call expect_fault("a(2)", "there is no function 'a' (there are sqrt, sin, cos, tan of "// &
                        "radians, and sind, cosd, tand of degrees)")
      call expect_fault(repeat("sin(", 60)//"1"//repeat(")", 60), "it is nested too deeply")
      call expect_fault("1e999", "the result is no finite number")
      call expect_fault("(-1)^0.5", "the result is no finite number")
      call expect_fault("1e", "'1e' is no number")
      call expect_fault("1.2.3", "'1.2.3' is no number")
      call expect_fault(repeat("(", 1000), "it is nested too deeply")
      call expect_fault(repeat("-", 1000)//"1", "it is nested too deeply")
   end subroutine check_faults

   subroutine expect_fault(expression, expected)
      character(len=*), intent(in) :: expression, expected
      character(len=:), allocatable :: fault
      real(rk) :: value

      call evaluate(expression, [constant_t ::], value, fault)
      if (.not. allocated(fault)) fault = "nothing"
      call checks%is_true(fault == expected, "'"//expression//"': "//fault)
   end subroutine expect_fault

   subroutine check_scene()
      call put_lines(path, [character(len=100) :: "&define", "half = 1.0, e_modulus = '4*10^10'", &
                            "sigma = 'e_modulus/4000' /", base])
      call read_scene(path, scene, error)
      call checks%no_error(error, "named values")
      if (allocated(error)) return
      call checks%is_close(scene%domain%x_max, 2.0_rk, 0.0_rk, "an expression")
      call checks%is_close(scene%material%young, 4.0e10_rk, 1.0e-15_rk, "a name")
      call checks%is_close(scene%fractures(1)%x(2), 1.1_rk, 1.0e-15_rk, "one of a list")
      call checks%is_close(scene%sides(4)%traction(2), -1.0e7_rk, 1.0e-15_rk, "in any case")
   end subroutine check_scene

   subroutine check_refusals()
      call refuse("&define half = 1.0 /", ":3: &material: young is 'e_modulus', which is no "// &
                  "expression: there is no value 'e_modulus' of &define before it"//doc)
     call refuse("&define a = 'b', b = 'a' /", ":1: &define: a is 'b', which is no expression: "// &
                  "there is no value 'b' of &define before it"//doc)
     call refuse("&define a = 'a' /", ":1: &define: a is 'a', which is no expression: there is "// &
                  "no value 'a' of &define before it"//doc)
      call refuse("&define a = 1.0, a = 2.0 /", ":1: &define: a is given twice, but must be "// &
                  "given once"//doc)
      call refuse("&define a = '1/0' /", ":1: &define: a is '1/0', which is no expression: it "// &
                  "divides by zero"//doc)
    call refuse("&define 2a = 1.0 /", ":1: &define: '2a' is no name, which has letters, digits "// &
                  "and '_', at most 64, and begins with a letter"//doc)
      call refuse("&define a = /", ":1: &define: a has no value"//doc)
      call refuse("&define a = 1.0 2.0 /", ":1: &define: '2.0' stands where 'name = value' or "// &
                  "the closing '/' is expected"//doc)
      call refuse("&define a = 1.0", ":2: &define: is not ended by '/' as it must be"//doc)
   end subroutine check_refusals

   subroutine refuse(line, message)
      character(len=*), intent(in) :: line, message
      character(len=100) :: lines(size(base) + 1)

      lines(1) = line
      lines(2:) = base
      call put_lines(path, lines)
      call read_scene(path, scene, error)
      call checks%fails_by(error, path//message)
   end subroutine refuse

end program test_scene_define
