!> What scene files say of wells: stages as lists and as a table, what is refused, and that
!! scene.nml holds all of it.
program test_scene_wells
   use base_errors, only: error_t
   use base_kinds, only: ik, rk
   use scene_namelist, only: read_scene
   use scene_test_files, only: delete_file, put_lines, same_scene
   use scene_types, only: scene_t
   use scene_write, only: scene_text
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_wells.nml", table = "test_scene_wells.csv"
   character(len=*), parameter :: again = "test_scene_wells_again.nml"
   character(len=*), parameter :: doc = " (see docs/input.md)"
   !&<
   character(len=100), parameter :: head(*) = [character(len=100) :: &
      "&scene name='base' /", &  ! 1
      "&domain x_min=0.0 x_max=2.0 y_min=0.0 y_max=1.0 /", &  ! 2
      "&material young=40.0e9 poisson=0.2 biot=0.8 porosity=0.01 permeability=5.0e-20 /", &  ! 3
      "&fluid compressibility=4.0e-10 viscosity=1.0e-4 /", &  ! 4
      "&fracture name='f1' x=0.9, 1.1 y=0.5, 0.6 friction=0.5 aperture=1.0e-3 /", &  ! 5
      "&side name='left' x_displacement=0.0 /", &  ! 6
      "&side name='bottom' y_displacement=0.0 /", &  ! 7
      "&time end=3600.0 /", &  ! 8
      "&coarse size_fracture=0.01 size_boundary=0.1 /"]  ! 9
   character(len=*), parameter :: second = &
                              " &fracture name='f2' x=0.9, 1.1 y=2*0.3 friction=0.5 aperture=1e-3 /"
   !&>
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(error_t), allocatable :: error

   call check_lists()
   call check_entries()
   call check_nearest()
   call check_table()
   call check_spreadsheets()
   call check_faults()
   call check_table_faults()
   call delete_file(path)
   call delete_file(again)
   call delete_file(table)
   call checks%finish()

contains

   !> Stages, what they stand for at any time, names, wells in the rock.
   subroutine check_lists()
      call read_with("&injection fracture='f1' time=0,10,20 rate=1e-7,2e-7,0 pressure=9e6 "// &
                     "end=30 /")
      call checks%no_error(error, "stages")
      associate (well => scene%injections(1))
         call checks%is_true(well%name == "well_1", "a name by number")
         call checks%is_true(all([well%stage_at(0.0_rk), well%stage_at(9.9_rk), &
                                  well%stage_at(10.0_rk), well%stage_at(29.0_rk), &
                                  well%stage_at(30.0_rk)] == [1_ik, 1_ik, 2_ik, 3_ik, 0_ik]), &
                             "stages in time")
         call checks%is_true(all(abs(well%pressure - 9.0e6_rk) < 1.0_rk) .and. &
                             size(well%pressure) == 3, "one pressure for all stages")
         call checks%is_true(well%is_controlled(), "a limit makes the rate an unknown")
      end associate
      call expect_same()
      call read_with("&injection name='deep' x=0.3 y=0.2 radius=0.05 rate=-1e-7 start=5 /")
      call checks%no_error(error, "a well in the rock")
      call checks%is_true(scene%injections(1)%fracture == 0 .and. &
                          .not. scene%injections(1)%is_controlled(), "at a rate, in no fracture")
      call checks%is_true(scene%injections(1)%stage_at(4.9_rk) == 0, "not before its start")
      call expect_same()
      call read_with("&injection fracture='f1' rate=1e-7 storage=1e-12 friction=1e9 "// &
                     "turbulence=1e15 /")
      call checks%no_error(error, "storage and losses")
      call checks%is_true(scene%injections(1)%is_controlled(), "storage makes it one too")
      call expect_same()
   end subroutine check_lists

   !> The fracture nearest to a point, and the place on it.
   subroutine check_nearest()
      call read_with("&injection fracture='nearest' rate=1e-7 x=1.0 y=0.2 entry_loss=1e12 /"// &
                     second)
      call checks%no_error(error, "the nearest fracture")
      associate (well => scene%injections(1))
         call checks%is_true(well%fracture == 2 .and. abs(well%x - 1.0_rk) < 1.0e-12_rk .and. &
                             abs(well%y - 0.3_rk) < 1.0e-12_rk, "the second, at its nearest place")
         call checks%is_true(well%entries(1)%fracture == 2 .and. &
                             abs(well%entries(1)%y - 0.3_rk) < 1.0e-12_rk, "its entry too")
         call checks%is_close(well%moved, 0.1_rk, 1.0e-12_rk, "moved by a tenth")
         call checks%is_true(well%next_distance > 0.3_rk .and. well%next_distance < 0.4_rk, &
                             "the first one is next")
      end associate
      call expect_same()
      call refuse("&injection fracture='nearest' rate=1e-7 /", ":10: &injection: fracture is "// &
                  "'nearest', which needs x and y, and must be the only one"//doc)
   end subroutine check_nearest

   !> Several fractures of one well, a loss at a single one, and a list of one name.
   subroutine check_entries()
      character(len=*), parameter :: here = ":10: &injection: "

      call read_with("&injection fracture='f1','f2' rate=1e-7 x=1,1.05 y=0.55,0.3 "// &
                     "entry_loss=1e12 /"//second)
      call checks%no_error(error, "two entries")
      associate (well => scene%injections(1))
         call checks%is_true(well%is_controlled() .and. well%has_given_flow(), &
                             "the flows are unknowns, their sum is given")
         call checks%is_true(all(well%entries%fracture == [1_ik, 2_ik]) .and. &
                             well%fracture == 1, "the fractures")
         call checks%is_close(maxval(abs(well%entries%loss - 1.0e12_rk)), 0.0_rk, 0.0_rk, &
                              "one loss for all")
         call checks%is_close(maxval(abs(well%entries%x - [1.0_rk, 1.05_rk])), 0.0_rk, 0.0_rk, &
                              "the points")
      end associate
      call expect_same()
      call read_with("&injection fracture='f1','f2' rate=1e-7 /&injection x=0.2 y=0.2 "// &
                     "radius=1e-4 rate=1e-9 /"//second)
      call checks%no_error(error, "and a well in the rock")
      call read_with("&injection fracture='f2','f1' rate=1e-7 /"//second)
      call checks%no_error(error, "entries along fractures")
      call expect_same()
      call read_with("&injection fracture='f1' rate=1e-7 entry_loss=1e12 /"//second)
      call checks%is_true(scene%injections(1)%entry_count() == 1 .and. &
                          allocated(scene%injections(1)%entries), "one entry with a loss")
      call expect_same()
      call read_with("&injection fracture='f1', rate=1e-7 entry_loss=0 /"//second)
      call checks%is_true(.not. allocated(scene%injections(1)%entries), "a well as before")
      call refuse("&injection fracture='f1','f1' rate=1e-7 /"//second, here// &
                  "fracture names 'f1' twice, but the entries of a well must be "// &
                  "in different fractures"//doc)
      call refuse("&injection fracture='f1','f3' rate=1e-7 /"//second, here// &
                  "fracture is 'f3', which is no fracture of the scene; the "// &
                  "nearest is 'f1'"//doc)
      call refuse("&injection fracture='f1','f2' rate=1e-7 x=1 y=0.55 /"//second, here// &
                  "x has 1 values but must have as many as fracture, 2"//doc)
      call refuse("&injection fracture='f1','f2' rate=1e-7 entry_loss=1,2,3 /"//second, here// &
                  "entry_loss has 3 values but must have as many as fracture, 2"//doc)
      call refuse("&injection fracture='f1' rate=1e-7 x=1,1 y=0.55,0.5 /"//second, here// &
                  "x has 2 values but must have one"//doc)
      call refuse("&injection x=0.3 y=0.2 rate=1e-7 entry_loss=1 /"//second, here// &
                  "entry_loss is given, but a well in the rock has no entries; "// &
                  "use friction"//doc)
      call refuse("&injection fracture='f1' rate=1e-7 entry_loss=-1 /"//second, here// &
                  "entry_loss is -1 but must be a finite number at least 0.0 [Pa "// &
                  "s2/m4]"//doc)
   end subroutine check_entries

   !> A table with comments, an empty line, blanks, columns in another order.
   subroutine check_table()
      call put_lines(table, [character(len=40) :: "# stages", "rate_m2_s, time_s", " 1e-7 , 0", &
                             "", "2.5e-7,60", "# and shut in", "0,120"])
      call read_with("&injection fracture='f1' schedule='"//table//"' rate=1e-7 /")
      call checks%fails_with(error, path//":10: &injection: rate is given with schedule", &
                             "what a table says is given once")
      call read_with("&injection fracture='f1' schedule='"//table//"' start=1.0 /")
      call checks%fails_with(error, path//":10: &injection: start is given with schedule", &
                             "when a table begins as well")
      call read_with("&injection fracture='f1' schedule='"//table//"' pressure=9e6 /")
      call checks%no_error(error, "a limit beside a table of rates")
      call read_with("&injection fracture='f1' schedule='"//table//"' /")
      call checks%no_error(error, "a table")
      associate (well => scene%injections(1))
         call checks%is_true(all(abs(well%time - [0.0_rk, 60.0_rk, 120.0_rk]) < 1.0e-12_rk) .and. &
                             all(abs(well%rate - [1.0e-7_rk, 2.5e-7_rk, 0.0_rk]) < 1.0e-20_rk), &
                             "times and rates of the table")
         call checks%is_true(.not. allocated(well%pressure), "and no pressure")
      end associate
      call expect_same()
   end subroutine check_table

   !> Tables as spreadsheets write them: a byte order mark, semicolons or tabs, decimal commas,
   !! quoted names, ends of lines from elsewhere, and hours and MPa.
   subroutine check_spreadsheets()
      character(len=*), parameter :: byte_order_mark = char(239)//char(187)//char(191)

      call expect_table([character(len=60) :: byte_order_mark// &
                         "time_s;rate_m2_s;pressure_pa"//achar(13), "0;1,5e-7;9e6"//achar(13), &
                         "5400,0;0;9000000,0"//achar(13)])
      call expect_table([character(len=60) :: "Time_H"//achar(9)//"Rate_m2_s"//achar(9)// &
                         "Pressure_MPa", "0"//achar(9)//"1.5e-7"//achar(9)//"9", &
                         "1,5"//achar(9)//"0"//achar(9)//"9,0"])
      call expect_table([character(len=60) :: '"time_min","rate_m2_s","pressure_bar"', &
                         "0,1.5e-7,90", "90,0,90"])
      call expect_table([character(len=60) :: "time_d,rate_m2_s,pressure_kpa", "0,1.5e-7,9e3", &
                         "0.0625,0,9000"])
   end subroutine check_spreadsheets

   !> A well with 1.5e-7 m2/s for an hour and a half and then none, up to 9 MPa.
   subroutine expect_table(lines)
      character(len=*), intent(in) :: lines(:)

      call put_lines(table, lines)
      call read_with("&injection fracture='f1' schedule='"//table//"' /")
      call checks%no_error(error, "a table of a spreadsheet: "//trim(lines(1)))
      if (allocated(error)) return
      associate (well => scene%injections(1))
         call checks%is_true(size(well%time) == 2 .and. well%stage_at(5399.9_rk) == 1_ik .and. &
                             well%stage_at(5400.1_rk) == 2_ik, "hours and minutes are seconds")
         call checks%is_close(well%rate(1), 1.5e-7_rk, 1.0e-12_rk, "a decimal comma")
         call checks%is_close(well%pressure(2), 9.0e6_rk, 1.0e-12_rk, "MPa, bar and kPa are Pa")
      end associate
      call expect_same()
   end subroutine expect_table

   subroutine check_faults()
      character(len=*), parameter :: here = ":10: &injection: "

      call refuse("&adaptive enabled=.true. /", ":10: &adaptive: enabled is .true., but with "// &
                  "&fluid the mesh is adapted to the response to wells, and there is no "// &
                  "&injection"//doc)
      call refuse("&injection x=0.3 y=0.2 radius=0.05 rate=-1e-7 / &adaptive enabled=.true. /", &
                  ":10: &adaptive: enabled is .true., but with &fluid the pressure of a well "// &
                  "in the rock depends on the size of its cell"//doc)
      call refuse("&injection fracture='f1' /", here//"rate is missing: a well needs a rate, a "// &
                  "pressure, or both"//doc)
      call refuse("&injection rate=1e-7 /", here//"fracture is missing: a well needs a "// &
                  "fracture, or x and y in the rock"//doc)
      call refuse("&injection fracture='f1' rate=1e-7 radius=0.1 /", here//"radius is given, "// &
                  "but only a well in the rock has one, and this one is in a fracture"//doc)
      call refuse("&injection fracture='f1' rate=1e-7 time=0 start=1 /", here//"start is "// &
                  "given with time, whose first value determines it, but must not be"//doc)
      call refuse("&injection fracture='f1' rate=1e-7,2e-7 /", here//"rate has 2 values but "// &
                  "must have one"//doc)
      call refuse("&injection fracture='f1' rate=1e-7,2e-7 time=0,10,20 /", here//"rate has 2 "// &
                  "values but must have as many as time, 3"//doc)
      call refuse("&injection fracture='f1' rate=1e-7,2e-7,0 time=0,20,10 /", here//"time "// &
                  "decreases: stage 3 begins at 10.0, but must begin after stage 2, 20.0"//doc)
      call refuse("&injection fracture='f1' rate=1e-7,2e-7 time=0,20 end=15 /", here//"end is "// &
                  "15.0 but must be after the beginning of the last stage, 20.0"//doc)
      call refuse("&injection x=0.3 y=1.2 rate=1e-7 /", here//"x and y are (0.3, 1.2) but must "// &
                  "lie within the domain"//doc)
      call refuse("&injection x=0.3 y=0.2 pressure=1e6 /", here//"radius is 0.1 but must be "// &
                  "at most a twentieth of the smallest cells, 5.0e-4, for a well with a "// &
                  "pressure control"//doc)
      call refuse("&injection x=0.3 y=0.2 radius=1e-4 pressure=1e6 turbulence=1 /", here// &
                  "turbulence is given, but a well in the rock with a pressure control must "// &
                  "not have it"//doc)
      call refuse("&initial pressure=1e6 / &injection fracture='f1' rate=-1e-7 pressure=-1e5 /", &
                  here//"pressure is -100000.0 but must be at least the vapour pressure, 0.0"//doc)
      call refuse("&injection fracture='f1' rate=1e-7 storage=-1 /", here//"storage is -1 but "// &
                  "must be a finite number at least 0.0 [m2/Pa]"//doc)
      call refuse("&injection name='a' fracture='f1' rate=1e-7 / &injection name='a' x=1 y=0.1 "// &
                  "rate=0 /", here//"name 'a' is already taken on line 10 but must be unique"//doc)
      call refuse("&injection fracture='f1' rate=1e-7 / &injection name='well_1' x=1 y=0.1 "// &
                  "rate=0 /", here//"name is 'well_1', as another well is called, but must be "// &
                  "unique"//doc)
      call refuse("&injection fracture='f1' schedule='none.csv' /", here//"schedule is "// &
                  "'none.csv', which is no file that can be read"//doc)
   end subroutine check_faults

   subroutine check_table_faults()
      call refuse_table("time_s,rate_gal", "0,1", ":1: the column 'rate_gal' must be one of "// &
                        "rate_m2_s, pressure_pa, time_s, temperature_k; or in place of _s "// &
                        "_min, _h or _d, of _pa _kpa, _mpa, _bar or _psi, of _m2_s _m3_s, "// &
                        "_l_s, _l_min, _m3_h or _bbl_min; `columns` takes other headers"//doc)
      call refuse_table("rate_m2_s,pressure_pa", "0,1", ":1: the column time_s is missing"//doc)
      call refuse_table("time_s,time_s", "0,1", ":1: the column 'time_s' is given twice"//doc)
      call refuse_table("time_s,rate_m2_s", "0", ":2: the row has 1 values but must have 2, "// &
                        "one per column"//doc)
      call refuse_table("time_s,time_h", "0,1", ":1: the column 'time_s' is given twice"//doc)
      call refuse_table("time_s,rate_m2_s", "0,5,1,2", ":2: the row has 4 values but must "// &
                        "have 2, one per column; with decimal commas, columns must be "// &
                        "separated by semicolons or tabs"//doc)
      call refuse_table("time_s;rate_m2_s", "0;1.000,5", ":2: rate_m2_s has several values"//doc)
      call refuse_table("time_s;rate_m2_s", "0,1e-7", ":2: the row has 1 values but must have "// &
                        "2, one per column"//doc)
      call refuse_table("time_s,rate_m2_s", "0,", ":2: rate_m2_s has no value"//doc)
      call refuse_table("time_s,rate_m2_s", "-5,1e-7", ":2: time_s is -5 but must be a finite "// &
                        "number at least 0.0 [s]"//doc)
      call refuse_table("time_s,rate_m2_s", "0,fast", ":2: rate_m2_s is fast but must be a "// &
                        "finite number like 4.0e10 [m2/s]"//doc)
   end subroutine check_table_faults

   !> Read the scene with a well.
   subroutine read_with(line)
      character(len=*), intent(in) :: line
      character(len=200) :: lines(size(head) + 1)

      lines(:size(head)) = head
      lines(size(lines)) = line
      call put_lines(path, lines)
      call read_scene(path, scene, error)
   end subroutine read_with

   !> What scene.nml holds gives the same scene.
   subroutine expect_same()
      type(scene_t) :: other

      call put_lines(again, [scene_text(scene)])
      call read_scene(again, other, error)
      call checks%no_error(error, "scene.nml of it")
      call checks%is_true(same_scene(scene, other), "scene.nml gives the same scene")
   end subroutine expect_same

   subroutine refuse(line, message)
      character(len=*), intent(in) :: line, message

      call read_with(line)
      call expect(path//message)
   end subroutine refuse

   !> A table of two lines.
   subroutine refuse_table(first, second, message)
      character(len=*), intent(in) :: first, second, message
      character(len=80) :: lines(2)

      lines(1) = first
      lines(2) = second
      call put_lines(table, lines)
      call read_with("&injection fracture='f1' schedule='"//table//"' /")
      call expect(table//message)
   end subroutine refuse_table

   subroutine expect(message)
      character(len=*), intent(in) :: message

      call checks%fails_by(error, message)
   end subroutine expect

end program test_scene_wells
