!> Faults in what a scene says of the faces of its fractures: each is refused with file, line and
!> name, and what would be right; and what is right goes through.
program test_scene_faces
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_namelist, only: read_scene
   use scene_test_files, only: delete_file, put_changed
   use scene_types, only: scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_faces.nml"
   character(len=*), parameter :: doc = " (see docs/input.md)"
   !&<
   character(len=110), parameter :: good(*) = [character(len=110) :: &
      "&domain x_min=0.0 x_max=2.0 y_min=0.0 y_max=1.0 /", &  ! 1
      "&material young=40.0e9 poisson=0.2 biot=0.8 porosity=0.01 permeability=5.0e-20", &  ! 2
      "  toughness=0.7e6 /", &  ! 3
      "&fluid compressibility=4.0e-10 viscosity=1.0e-4 /", &  ! 4
      "&fracture name='f1' x=0.9, 1.1 y=0.5, 0.6 friction=0.5 aperture=1.0e-3", &  ! 5
      "  normal_stiffness=1.0e10 closure=5.0e-4", &  ! 6
      "  friction_residual=0.5 weakening_slip=1.0e-3 cohesion=5.0e6", &  ! 7
      "  tensile_strength=2.0e6 opening_weakening=1.0e-4", &  ! 8
      "  toughness=0.5e6 skin=1.0e9 /", &  ! 9
      "&side name='left' x_displacement=0.0 /", &  ! 10
      "&side name='bottom' y_displacement=0.0 /", &  ! 11
      "&time end=3600.0 /", &  ! 12
      "&coarse size_fracture=0.01 size_boundary=0.1 /", &  ! 13
      "&fine window=0.2 /", &  ! 14
      "&growth intensities=.true. /"]  ! 15
   character(len=110), parameter :: dry(*) = [character(len=110) :: &
      "&domain x_min=0.0 x_max=2.0 y_min=0.0 y_max=1.0 /", &  ! 1
      "&material young=40.0e9 poisson=0.2 /", &  ! 2
      "&fracture name='f1' x=0.9, 1.1 y=0.5, 0.6 friction=0.5", &  ! 3
      "  normal_stiffness=1.0e10 closure=5.0e-4", &  ! 4
      "  /", &  ! 5
      "&side name='left' x_displacement=0.0 /", &  ! 6
      "&side name='bottom' y_displacement=0.0 /", &  ! 7
      "&fe size_fracture=0.02 size_boundary=0.1 /"]  ! 8
   !&>
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(error_t), allocatable :: error

   call check_good()
   call check_closure()
   call check_bond()
   call check_others()
   call check_dry()
   call delete_file(path)
   call checks%finish()

contains

   subroutine check_good()
      call put_changed(path, good, 1, good(1), 1, good(1))
      call read_scene(path, scene, error)
      call checks%no_error(error, "the scene without a fault")
      if (allocated(error)) return
      associate (f => scene%fractures(1))
         call checks%is_close(f%closure, 5.0e-4_rk, 0.0_rk, "closure")
         call checks%is_close(f%tensile_strength, 2.0e6_rk, 0.0_rk, "tensile strength")
         call checks%is_close(f%skin, 1.0e9_rk, 0.0_rk, "skin")
         call checks%is_close(f%toughness, 0.5e6_rk, 0.0_rk, "toughness")
      end associate
   end subroutine check_good

   subroutine check_closure()
      call refuse(good, 6, "  normal_stiffness=1.0e10", ":5: &fracture: closure is missing "// &
                  "but must be given with normal_stiffness"//doc)
      call refuse(good, 6, "  closure=5.0e-4", ":5: &fracture: normal_stiffness is "// &
                  "missing but must be given with closure"//doc)
      call refuse(good, 6, "  normal_stiffness=0.0 closure=5.0e-4", ":6: &fracture: "// &
                  "normal_stiffness is 0.0 but must be a finite number greater than 0.0 "// &
                  "[Pa/m]"//doc)
      call refuse(good, 6, "  normal_stiffness=1.0e10 closure=1.0e-3", ":6: &fracture: "// &
                  "closure is 0.001 m but must be at most 0.98 of the aperture, 9.8e-4 m, "// &
                  "since a part of it remains open under any stress"//doc)
   end subroutine check_closure

   subroutine check_bond()
      call refuse(good, 7, "  cohesion=5.0e6", ":7: &fracture: cohesion is given, but "// &
                  "weakening_slip, the slip that breaks the bond, is missing"//doc)
      call refuse(good, 7, "  ", ":8: &fracture: tensile_strength is given, but cohesion, the "// &
                  "shear strength of the same bond, is missing"//doc)
      call refuse(good, 8, "  tensile_strength=2.0e6", ":5: &fracture: opening_weakening is "// &
                  "missing but must be given with tensile_strength"//doc)
      call refuse(good, 8, "  tensile_strength=11.0e6 opening_weakening=1.0e-4", ":8: "// &
                  "&fracture: tensile_strength is 1.1e7 Pa but must be at most "// &
                  "cohesion/friction, 1.0e7 Pa, where the shear strength is none"//doc)
      call refuse(good, 7, "  friction_residual=0.5 weakening_slip=1.0e-3 cohesion=-1.0", &
                  ":7: &fracture: cohesion is -1.0 but must be a finite number greater than "// &
                  "0.0 [Pa]"//doc)
   end subroutine check_bond

   subroutine check_others()
      call refuse(good, 9, "  toughness=-1.0 /", ":9: &fracture: toughness is -1.0 but must be "// &
                  "a finite number at least 0.0 [Pa m^1/2]"//doc)
      call refuse(good, 3, "  /", ":9: &fracture: toughness is given, but that of &material, "// &
                  "which other tips have, is missing"//doc)
      call refuse(good, 9, "  skin=-1.0e9 /", ":9: &fracture: skin is -1.0e9 but must be a "// &
                  "finite number greater than 0.0 [Pa s/m]"//doc)
   end subroutine check_others

   subroutine check_dry()
      call put_changed(path, dry, 1, dry(1), 1, dry(1))
      call read_scene(path, scene, error)
      call checks%no_error(error, "without a fluid there is no aperture to be closed")
      call refuse(dry, 5, "  held_closed=.true. /", ":4: &fracture: normal_stiffness is "// &
                  "given, but faces that are held closed, held_closed = .true., cannot close "// &
                  "further; omit one of them"//doc)
      call refuse(dry, 3, "&fracture name='f1' x=0.9, 1.1 y=0.5, 0.6 law='open'", ":4: "// &
                  "&fracture: normal_stiffness is given, but the faces of the law 'open' do "// &
                  "not touch; give 'friction' or 'frictionless'"//doc)
      call refuse(dry, 4, "  held_closed=.true. friction_residual=0.1 weakening_slip=1e-3 "// &
                  "cohesion=1e6", ":4: &fracture: cohesion is given, but a bond of faces that "// &
                  "are held closed, held_closed = .true., never breaks; omit one of them"//doc)
      call refuse(dry, 4, "  skin=1.0e9", ":4: &fracture: skin needs a fluid, but the "// &
                  "group &fluid is missing"//doc)
   end subroutine check_dry

   !> A scene with one other line is refused with this message.
   subroutine refuse(lines, number, line, message)
      character(len=*), intent(in) :: lines(:)
      integer, intent(in) :: number
      character(len=*), intent(in) :: line, message

      call put_changed(path, lines, number, line, number, line)
      call read_scene(path, scene, error)
      call checks%fails_by(error, path//message)
   end subroutine refuse

end program test_scene_faces
