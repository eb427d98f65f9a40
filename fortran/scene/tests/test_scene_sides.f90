!> Sides in the course of time: lists, tables, values between the times, and what is refused.
program test_scene_sides
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_namelist, only: read_scene
   use scene_sides, only: in_time, mean_in_time
   use scene_test_files, only: delete_file, put_bytes, put_lines
   use scene_types, only: scene_t
   use scene_write, only: scene_text
   use testing_checks, only: checks_t
   implicit none(type, external)

   character(len=*), parameter :: path = "test_scene_sides.nml", table = "test_scene_sides.csv", &
                                  again = "test_scene_sides_again.nml"
   !&<
   character(len=80), parameter :: good(*) = [character(len=80) :: &
      "&domain x_min=0.0 x_max=2.0 y_min=0.0 y_max=1.0 /", &  ! 1
      "&material young=40.0e9 poisson=0.2 biot=0.8 porosity=0.01", &
      "  permeability=5.0e-20 /", &  ! 3
      "&fluid compressibility=4.0e-10 viscosity=1.0e-4 /", &
      "&side name='left' x_displacement=0.0 /", &  ! 5
      "&side name='bottom' y_displacement=0.0 /", &
      "&time end=3600.0 /", &  ! 7
      "&coarse size_boundary=0.1 /"]
   !&>
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(error_t), allocatable :: error

   call check_values()
   call check_changes()
   call check_lists()
   call check_table()
   call check_faults()
   call delete_file(path)
   call delete_file(again)
   call delete_file(table)
   call checks%finish()

contains

   subroutine read_with(side)
      character(len=*), intent(in) :: side

      call put_lines(path, [character(len=200) :: good, side])
      call read_scene(path, scene, error)
   end subroutine read_with

   !> What is written says the same.
   subroutine expect_same()
      type(scene_t) :: same

      call put_bytes(again, scene_text(scene))
      call read_scene(again, same, error)
      call checks%no_error(error, "what is written")
      call checks%is_true(scene_text(same) == scene_text(scene), "what is written says the same")
   end subroutine expect_same

   !> Between, before and after times; a jump counts after its time; the mean is exact.
   subroutine check_values()
      real(rk), parameter :: times(4) = [10.0_rk, 20.0_rk, 20.0_rk, 40.0_rk], &
                             values(4) = [1.0_rk, 3.0_rk, -1.0_rk, 1.0_rk]

      call checks%is_close(in_time(times, values, 0.0_rk), 1.0_rk, 0.0_rk, "before the first time")
      call checks%is_close(in_time(times, values, 15.0_rk), 2.0_rk, 1.0e-15_rk, "between")
      call checks%is_close(in_time(times, values, 20.0_rk), 3.0_rk, 1.0e-15_rk, "before a jump")
      call checks%is_close(in_time(times, values, 20.0_rk + 1.0e-9_rk), -1.0_rk, 1.0e-9_rk, &
                           "after a jump")
      call checks%is_close(in_time(times, values, 50.0_rk), 1.0_rk, 0.0_rk, "after the last time")
      call checks%is_close(mean_in_time(times, values, 0.0_rk, 60.0_rk), &
                           (10.0_rk + 20.0_rk + 0.0_rk + 20.0_rk)/60.0_rk, 1.0e-15_rk, &
                           "mean of all")
      call checks%is_close(mean_in_time(times, values, 18.0_rk, 22.0_rk), &
                           (2.0_rk*2.8_rk - 2.0_rk*0.9_rk)/4.0_rk, 1.0e-14_rk, "mean over a jump")
      call checks%is_close(mean_in_time(times, values, 2.0_rk, 4.0_rk), 1.0_rk, 1.0e-15_rk, &
                           "mean before")
      call checks%is_close(mean_in_time(times, values, 45.0_rk, 70.0_rk), 1.0_rk, 1.0e-15_rk, &
                           "mean after")
      call checks%is_close(mean_in_time(times, values, 15.0_rk, 15.0_rk), 2.0_rk, 1.0e-15_rk, &
                           "mean of a moment")
   end subroutine check_values

   !> Values that change beside one that does not; springs.
   subroutine check_lists()
      call read_with("&side name='right' time=0,10,10 x_traction=-1e6,-2e6,0 pressure=1e6 "// &
                     "y_spring=1e9 /")
      call checks%no_error(error, "lists")
      associate (side => scene%sides(2))
         call checks%is_true(side%changes(), "it changes")
         call checks%is_close(side%traction(1), -1.0e6_rk, 0.0_rk, "the first value")
         call side%set_time(5.0_rk, 4.0_rk)
         call checks%is_close(side%traction(1), -1.5e6_rk, 1.0e-9_rk, "the value of a time")
         call checks%is_close(side%pressure, 1.0e6_rk, 0.0_rk, "a constant")
         call checks%is_close(side%spring(2), 1.0e9_rk, 0.0_rk, "a spring")
         call checks%is_close(side%largest_stress(), 2.0e6_rk, 0.0_rk, "the largest stress")
      end associate
      call checks%is_true(.not. scene%sides(1)%changes(), "another side does not")
      call expect_same()
   end subroutine check_lists

   !> A table in a file, with a constant beside it.
   subroutine check_table()
      call put_lines(table, [character(len=40) :: "time_s, pressure_pa", "0, 1e6", "60, 2e6"])
      call read_with("&side name='top' schedule='"//table//"' y_traction=-1e6 /")
      call checks%no_error(error, "a table")
      call scene%sides(4)%set_time(30.0_rk, 30.0_rk)
      call checks%is_close(scene%sides(4)%pressure, 1.5e6_rk, 1.0e-9_rk, "a value of the table")
      call checks%is_close(scene%sides(4)%traction(2), -1.0e6_rk, 0.0_rk, "a constant beside it")
      call expect_same()
      call read_with("&side name='top' schedule='"//table//"' pressure=1e6 /")
      call checks%fails_with(error, path//":9: &side: pressure is given with schedule", &
                             "what a table says is given once")
   end subroutine check_table

   !> The changes of a pressure and their mean age are those of its course; a jump has its age.
   subroutine check_changes()
      real(rk), parameter :: small = 1.0e-12_rk
      real(rk), allocatable :: age(:), change(:)

      call read_with("&side name='right' time=0,10,10,20 pressure=1e6,1e6,3e6,7e6 /")
      call checks%no_error(error, "a pressure that changes")
      associate (side => scene%sides(2))
         call side%pressure_changes(5.0e5_rk, 20.0_rk, age, change)
         call checks%is_close(sum(change), 6.5e6_rk, small*6.5e6_rk, "all changes")
         call checks%is_close(sum(change*age), 5.0e7_rk, small*5.0e7_rk, "their mean age")
         call checks%is_true(size(age) == 12, "one between two halvings")
         call side%pressure_changes(1.0e6_rk, 10.5_rk, age, change)
         call checks%is_close(sum(change), 2.2e6_rk, small*2.2e6_rk, "part of a ramp")
         call checks%is_true(all(age <= 0.5_rk), "no older ones")
         call side%pressure_changes(1.0e6_rk, 5.0_rk, age, change)
         call checks%is_true(size(age) == 1 .and. all(abs(change) <= 0.0_rk), "none yet")
         call checks%is_close(age(1), 5.0_rk, 0.0_rk, "its age")
      end associate
   end subroutine check_changes

   subroutine check_faults()
      call expect("time=0,10 x_traction=-1e6,-2e6,0", ":9: &side: x_traction has 3 values but "// &
                  "must have one, or as many as time, 2")
      call expect("x_traction=-1e6,-2e6", ":9: &side: x_traction has 2 values but must have "// &
                  "one, unless time says when they hold")
      call expect("time=0,10 x_traction=-1e6", ":9: &side: time is given, but no value of the "// &
                  "side changes with it")
      call expect("time=0,10,5 x_traction=0,1,2", ":9: &side: time decreases from 10.0 to 5.0")
      call expect("time=0,5,5,5 x_traction=0,1,2,3", ":9: &side: time has 5.0 three times")
      call expect("pressure=1e6 inflow=1e-9", ":9: &side: inflow is given with pressure")
      call expect("x_displacement=0 x_spring=1e9", ":9: &side: x_spring is given with "// &
                  "x_displacement")
      call expect("y_spring=-1e9", ":9: &side: y_spring is -1e9 but must be a finite number"// &
                  " greater than 0.0")
      call expect("time=-1,5 x_traction=0,1", ":9: &side: time is -1 but must be a finite "// &
                  "number at least 0.0")
   end subroutine check_faults

   subroutine expect(side, words)
      character(len=*), intent(in) :: side, words

      call read_with("&side name='right' "//side//" /")
      call checks%fails_with(error, path//words, side)
   end subroutine expect

end program test_scene_sides
