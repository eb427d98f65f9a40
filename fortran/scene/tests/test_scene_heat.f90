!> Scenes with heat: what is read and written, and what is refused.
program test_scene_heat
   use base_errors, only: error_t
   use base_kinds, only: rk
   use scene_namelist, only: read_scene
   use scene_test_files, only: delete_file, put_bytes, put_changed, put_lines
   use scene_types, only: scene_t
   use scene_write, only: scene_text
   use testing_checks, only: checks_t
   implicit none(type, external)
   character(len=*), parameter :: path = "test_scene_heat.nml"
   character(len=*), parameter :: doc = " (see docs/input.md)"
   !&<
   character(len=100), parameter :: good(*) = [character(len=100) :: &
      "&scene name='warm' /", &  ! 1
      "&domain x_min=0.0 x_max=2.0 y_min=0.0 y_max=1.0 /", &  ! 2
      "&material young=40.0e9 poisson=0.2 biot=0.8 porosity=0.01 permeability=5.0e-20", &  ! 3
      "  toughness=1.0e6 heat_capacity=2.2e6 heat_conductivity=2.6 /", &  ! 4
      "&fluid compressibility=4e-10 viscosity=1e-3 heat_capacity=4e6 heat_expansion=4e-4 /", &  ! 5
      "&fracture name='f1' x=0.9, 1.1 y=0.5, 0.6 friction=0.5 aperture=1.0e-3 /", &  ! 6
      "&side name='left' x_displacement=0.0 temperature=80.0 /", &  ! 7
      "&side name='bottom' y_displacement=0.0 heat_flux=0.06 /", &  ! 8
      "&injection fracture='f1' time=0.0, 60.0 rate=1.0e-9, 2.0e-9 temperature=20.0 /", &  ! 9
      "&heat temperature=150.0 temperature_per_y=-0.03 /", &  ! 10
      "&region name='r' shape='half_plane' x=1.0, 1.0 y=0.0, 1.0 heat_capacity=1.0e6", &  ! 11
      "  heat_expansion=2.4e-5 /", &  ! 12
      "&time end=3600.0 step=60.0 /", &  ! 13
      "&growth enabled=.false. /"]  ! 14
   !&>
   type(checks_t) :: checks
   type(scene_t) :: scene
   type(error_t), allocatable :: error
   integer :: k

   call put_lines(path, good)
   do k = 1, 2
      call read_scene(path, scene, error)
      call checks%no_error(error, "a scene with heat")
      if (allocated(error)) exit
      call checks%is_close(scene%heat%temperature_per_y, -0.03_rk, 0.0_rk, "gradient")
      call checks%is_close(scene%injections(1)%temperature(2), 20.0_rk, 0.0_rk, "of each stage")
      call checks%is_true(scene%sides(1)%temperature_given .and. &
                          .not. scene%sides(3)%temperature_given, "sides with a temperature")
      call checks%is_close(scene%sides(3)%heat_flux, 0.06_rk, 0.0_rk, "heat flux")
      call checks%is_close(scene%regions(1)%material%heat_capacity, 1.0e6_rk, 0.0_rk, "region")
      call checks%is_close(scene%regions(1)%material%heat_conductivity, 2.6_rk, 0.0_rk, &
                           "of the scene's rock")
      call checks%is_close(scene%material%heat_expansion, 0.0_rk, 0.0_rk, "none is given")
      call checks%is_close(scene%regions(1)%material%heat_expansion, 2.4e-5_rk, 0.0_rk, "expansion")
      call checks%is_close(scene%fluid%heat_expansion, 4.0e-4_rk, 0.0_rk, "of the fluid")
      call put_bytes(path, scene_text(scene))
   end do
   call refuse(10, "", ":4: &material: heat_capacity is given, but the scene has no group &heat")
   call refuse(4, "  toughness=1.0e6 heat_capacity=2.2e6 /", &
               ":3: &material: heat_conductivity is missing but must be given with &heat")
   call refuse(5, "&fluid compressibility=4.0e-10 viscosity=1.0e-3 /", &
               ":5: &fluid: heat_capacity is missing but must be given with &heat")
   call refuse(7, "&side name='left' x_displacement=0.0 temperature=80.0 heat_flux=1.0 /", &
               ":7: &side: heat_flux is given with temperature, but only one of them can be "// &
               "prescribed")
   call refuse(9, "&injection fracture='f1' rate=1.0e-9 /", ":9: &injection: temperature is "// &
               "missing, but with &heat a well that may inject must have one")
   call refuse(9, "&injection fracture='f1' rate=1.0e-9 temperature=20.0, 30.0 /", &
               ":9: &injection: temperature has 2 values but must have one, or one per stage, 1")
   call refuse(10, "&heat temperature=150.0 tolerance=2.0 /", &
               ":10: &heat: tolerance is 2.0 but must be a finite number "// &
               "greater than 0.0 and at most 1.0")
   call refuse_table("20.0, 200.0", "2e-3, 1e-3, 5e-4", "6: &fluid: viscosity_at has 3 values "// &
                     "but must have one for each table_temperature, 2")
   call refuse_table("20.0, 20.0", "2e-3, 1e-3", "6: &fluid: table_temperature must have at "// &
                     "least two values, which increase")
   call refuse_table("50.0, 200.0", "2e-3, 1e-3", "6: &fluid: table_temperature reaches from "// &
                     "50.0 to 200.0 but must contain the temperatures of the scene, 20.0 to 150.0")
   call refuse_table("20.0, 200.0", "4e-3, 2e-3", "5: &fluid: viscosity is 0.001 but must be "// &
                     "that of the table at the temperature of &heat, 0.002425, which the "// &
                     "rock takes")
   call refuse(10, "&heat temperature=150.0 source_power=1.0, 2.0 source_x=1.0 source_y=0.5 /", &
               ":10: &heat: source_power has 2 values, but source_x and source_y must have as many")
   call refuse(10, "&heat temperature=150.0 source_power=1.0 source_x=1.0 source_y=1.5 /", &
               ":10: &heat: source_x and source_y have (1.0, 1.5), which must lie in the body")
   call put_changed(path, good, 9, "&injection fracture='f1' rate=-1.0e-9 /", 9, &
                    "&injection fracture='f1' rate=-1.0e-9 /")
   call read_scene(path, scene, error)
   call checks%no_error(error, "a well that only extracts has no temperature")
   call delete_file(path)
   call checks%finish()

contains

   subroutine refuse_table(temperatures, viscosities, words)
      character(len=*), intent(in) :: temperatures, viscosities, words

      call put_lines(path, [character(len=100) :: good(:4), &
                            "&fluid compressibility=4e-10 viscosity=1e-3 heat_capacity=4e6", &
                            "table_temperature="//temperatures//" viscosity_at="//viscosities// &
                            " /", good(6:)])
      call read_scene(path, scene, error)
      call checks%fails_with(error, path//":"//words//doc, words)
   end subroutine refuse_table

   subroutine refuse(line, text, words)
      integer, intent(in) :: line
      character(len=*), intent(in) :: text, words

      call put_changed(path, good, line, text, line, text)
      call read_scene(path, scene, error)
      call checks%fails_with(error, path//words//doc, text)
   end subroutine refuse

end program test_scene_heat
