!> Scene files that include others: where paths are seen from, which file and line an error names,
!! what is refused, and that scene.nml holds everything.
program test_scene_include
   use base_errors, only: error_t
   use scene_namelist, only: read_scene
   use scene_test_files, only: delete_file, put_lines, same_scene
   use scene_types, only: scene_t
   use scene_write, only: scene_text
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_include.nml"
   character(len=*), parameter :: rock = "test_scene_include_rock.inc"
   character(len=*), parameter :: cracks = "test_scene_include_cracks.inc"
   character(len=*), parameter :: doc = " (see docs/input.md)"
   !&<
   character(len=80), parameter :: base(*) = [character(len=80) :: &
      "&scene name='base' /", &
      "&domain x_min=0.0 x_max=2.0 y_min=0.0 y_max=1.0 /", &
      "&side name='left' x_displacement=0.0 /", &
      "&side name='bottom' y_displacement=0.0 /", &
      "&time end=3600.0 /", &
      "&coarse size_fracture=0.01 size_boundary=0.1 /"]
   character(len=100), parameter :: granite(*) = [character(len=100) :: &
      "! granite", &
      "&material young=40.0e9 poisson=0.2 biot=0.8 porosity=0.01 permeability=5.0e-20 /", &
      "&fluid compressibility=4.0e-10 viscosity=1.0e-4 /"]
   character(len=100), parameter :: f1(*) = [character(len=100) :: &
      "", "&fracture name='f1' x=0.9, 1.1 y=0.5, 0.6 friction=0.5 aperture=1.0e-3 /"]
   !&>
   type(checks_t) :: checks
   type(scene_t) :: scene, other
   type(error_t), allocatable :: error

   call check_nested()
   call check_places()
   call check_refusals()
   call delete_file(path)
   call delete_file(rock)
   call delete_file(cracks)
   call checks%finish()

contains

   !> The same as the one long file, and so is what it writes.
   subroutine check_nested()
      call put_lines(path, [character(len=100) :: base, granite, f1])
      call read_scene(path, other, error)
      call checks%no_error(error, "one file")
      call put_lines(cracks, f1)
      call put_lines(rock, [character(len=100) :: granite, 'INCLUDE "'//cracks//'"'])
      call put_lines(path, [character(len=100) :: "include '"//rock//"'  ! both", base])
      call read_scene("./"//path, scene, error)
      call checks%no_error(error, "an include within an include")
      call checks%is_true(same_scene(scene, other), "the groups stand where the include is")
      call put_lines(path, [scene_text(scene)])
      call read_scene(path, other, error)
      call checks%no_error(error, "scene.nml of it")
      call checks%is_true(same_scene(scene, other), "scene.nml needs no other file")
   end subroutine check_nested

   !> Errors name the file and line where it stands.
   subroutine check_places()
      call put_lines(path, [character(len=100) :: "include '"//rock//"'", base, f1])
      call put_lines(rock, [character(len=100) :: granite, "&probe name='p' x=9.0 y=0.5 /"])
      call expect(rock//":4: &probe: x and y of probe 'p' are (9.0, 0.5) but must "// &
                  "lie within the domain"//doc)
      call put_lines(rock, [character(len=100) :: granite, "&time step=yes /"])
      call expect(rock//":4: &time: step is yes but must be a finite number greater than "// &
                  "0.0 [s]"//doc)
      call put_lines(rock, [character(len=100) :: granite, "&tine /"])
      call expect(rock//":4: unknown group &tine, the nearest is &time"//doc)
      call put_lines(rock, [character(len=100) :: granite, "&time end=1.0 /"])
      call expect(path//":6: &time: is given twice, first on line 4 of "//rock// &
                  ", but must be given once: put all its names there"//doc)
      call put_lines(rock, [character(len=100) :: granite, f1])
      call expect(path//":9: &fracture: name 'f1' is already taken on line 5 of "//rock// &
                  " but must be unique"//doc)
      call put_lines(rock, [character(len=100) :: granite, "&side name='top' y_traction='"])
      call expect(rock//":4: a text in quotes is not closed on its line")
call put_lines(rock, [character(len=100) :: granite, "&injection fracture='f1' schedule='n.csv' /"])
      call expect(rock//":4: &injection: schedule is 'n.csv', which is no file that can be read"// &
                  doc)
   end subroutine check_places

   subroutine check_refusals()
      call put_lines(path, [character(len=100) :: base, "include 'nowhere.inc'"])
      call expect(path//":7: include 'nowhere.inc': there is no file nowhere.inc")
      call put_lines(path, [character(len=100) :: base, "include '"//path//"'"])
      call expect(path//":7: include '"//path// &
                  "' is circular: that file includes this one")
      call put_lines(path, [character(len=100) :: base, "include '"//rock//"'"])
      call put_lines(rock, [character(len=100) :: granite, "include '"//path//"'"])
      call expect(rock//":4: include '"//path// &
                  "' is circular: that file includes this one")
      call put_lines(path, [character(len=100) :: "include './"//path//"'"])
      call read_scene(path, scene, error)
      call checks%is_true(allocated(error), "a circle by another name ends too")
      call put_lines(path, [character(len=100) :: base, "include rock.inc"])
      call expect(path//":7: text outside of a group, where only comments are allowed")
      call put_lines(path, [character(len=100) :: base, "&output include 'rock.inc' /"])
      call read_scene(path, scene, error)
      call checks%is_true(allocated(error), "within a group it is no include")
   end subroutine check_refusals

   subroutine expect(message)
      character(len=*), intent(in) :: message

      call read_scene(path, scene, error)
      call checks%fails_by(error, message)
   end subroutine expect

end program test_scene_include
