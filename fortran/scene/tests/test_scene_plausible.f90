!> What a scene says that is hardly meant: each doubt by a value just past its bound and none at it,
!> and none about a scene as it should be.
program test_scene_plausible
   use base_kinds, only: radians, rk
   use base_texts, only: text_t
   use scene_plausible, only: doubts, doubts_of_scene
   use scene_types, only: boundary_part_t, fracture_t, injection_t, point_load_t, region_t, &
                          restraint_t, scene_t
   use testing_checks, only: checks_t
   implicit none(type, external)
   type(checks_t) :: checks
   type(scene_t) :: scene, solid
   integer :: provoked = 0

   scene = sound()
   solid = sound()
   solid%fluid%viscosity = 0.0_rk
   call expect(scene, "", "a scene with a fluid")
   call expect(solid, "", "a scene without")

   scene%material%young = 40.0_rk
   call expect(scene, "&material: young is 40.0 Pa: rock has 1e9 to 1e11 Pa", "young")
   call test_material()
   call test_fractures()
   call test_flow()
   call test_column()
   call test_regions()
   call test_ends()
   call test_regime()
   call test_restraints()
   call checks%is_true(provoked == size(doubts), "every doubt is provoked")
   call checks%finish()

contains

   !> K_m of 0.2 and 0.18: E' = 32 GPa, and mu' Q such that (E'^3 mu' Q)**(1/4) is 5 K' or K'/0.18.
   subroutine test_regime()
      type(scene_t) :: s
      real(rk), parameter :: k = 3.191538243211461e6_rk  ! sqrt(32/pi) times 1 MPa sqrt(m)

      s = sound()
      s%growth%enabled = .true.
      s%material%young = 30.0e9_rk
      s%material%poisson = 0.25_rk
      s%material%toughness = 1.0e6_rk
      s%fluid%viscosity = 1.0e-3_rk
      s%fractures = [fracture_t(name="a", x=[0.3_rk, 0.7_rk], y=[1.0_rk, 1.0_rk])]
      s%injections = [injection_t(name="w", fracture=1, &
                                  rate=[0.0_rk, 625.0_rk*k**4/(32.0e9_rk**3*12.0e-3_rk)])]
      call expect(s, "", "K_m = 0.2")
      s%injections(1)%rate = s%injections(1)%rate/0.9_rk**4
      call expect(s, "&injection 'w': K_m is 0.18: growth is then viscosity-dominated", "0.18")
      s%injections(1)%rate = -s%injections(1)%rate
      call expect(s, "", "a well that draws")
      s%injections(1)%rate = -s%injections(1)%rate
      s%injections(1)%fracture = 0
      call expect(s, "", "a well in the rock")
      s%injections(1)%fracture = 1
      s%growth%enabled = .false.
      call expect(s, "", "without growth")
   end subroutine test_regime

   !> Ends within 1 mm, 0.05 increments, of a fracture or a side.
   subroutine test_ends()
      type(scene_t) :: s

      s = sound()
      s%growth%enabled = .true.
      s%growth%increment = 0.02_rk
      s%fractures = [fracture_t(name="a", x=[0.3_rk, 0.7_rk], y=[1.0_rk, 1.0_rk]), &
                     fracture_t(name="b", x=[0.702_rk, 0.702_rk], y=[0.8_rk, 1.3_rk])]
      call expect(s, "", "2 mm apart")
      s%fractures(2)%x = [0.7_rk, 0.7_rk]
      call expect(s, "", "a T")
      s%fractures(2)%x = [0.7005_rk, 0.7005_rk]
      call expect(s, "&fracture 'a' to 'b': gap is 5.0e-4 m: the ligament fails", "a gap")
      s%fractures(2)%x = [0.7005_rk, 0.9_rk]
      s%fractures(2)%y = [1.0_rk, 1.3_rk]
      call expect(s, "&fracture 'a' to 'b': gap is 5.0e-4 m: ", "end to end, once", .true.)
      s%fractures = s%fractures(2:1:-1)
      call expect(s, "&fracture 'b' to 'a': gap is 5.0e-4 m: ", "in the other order", .true.)
      s%fractures(1)%x = [0.6992_rk, 0.6992_rk]
      s%fractures(1)%y = [0.8_rk, 1.3_rk]
      call expect(s, "&fracture 'a' past 'b': stub is 8.0e-4 m: its end is a separate", "a stub")
      s%fractures(1)%x = [0.5_rk, 0.5_rk]
      call expect(s, "", "a cross")
      s%fractures(1)%x = [0.3_rk, 0.3_rk]
      s%fractures(1)%y = [1.0_rk, 1.9993_rk]
      call expect(s, "&fracture 'b' to the side 'top': gap is 7.0e-4 m: ", "near a side", .true.)
      s%fractures(1)%y(2) = 2.0_rk
      call expect(s, "", "on a side, and sharing an end")
      s%fractures(1)%y = [0.9_rk, 1.9993_rk]
      s%growth%enabled = .false.
      call expect(s, "", "no growth")
   end subroutine test_ends

   !> What sides leave of the rigid motions, restraints may take.
   subroutine test_restraints()
      type(scene_t) :: s

      s = sound()
      s%sides(1)%displacement_given(1) = .true.
      s%point_loads = [point_load_t ::]
      s%restraints = [restraint_t(0.0_rk, 0.0_rk, [.false., .true.], [0.0_rk, 0.0_rk])]
      call expect(s, "", "a component beside a side of rollers")
      s%restraints(1)%displacement_given(1) = .true.
      call expect(s, "&restraint: surplus is 1.0: they are then point loads", "held twice")
      s%sides(1)%displacement_given(1) = .false.
      s%restraints = [s%restraints, &
                      restraint_t(1.0_rk, 0.0_rk, [.false., .true.], [0.0_rk, 0.0_rk])]
      call expect(s, "", "three components")
      s%sides(3)%spring(2) = 1.0e9_rk
      call expect(s, "&restraint: surplus is 2.0: ", "three beside springs", .true.)
   end subroutine test_restraints

   !> A band through the body of 2 m, thinner than cells far from fractures, or very permeable.
   subroutine test_regions()
      type(scene_t) :: s

      s = sound()
      s%discretization%size_boundary = 0.1_rk
      s%regions = [region_t(name="band", x=[0.0_rk, 2.0_rk, 2.0_rk, 0.0_rk], &
                            y=[0.5_rk, 0.5_rk, 0.62_rk, 0.62_rk])]
      s%regions(1)%material%permeability_xx = 1.0e-15_rk
      s%regions(1)%material%permeability_yy = 1.0e-15_rk
      call expect(s, "", "a band of 0.12 m")
      s%regions(1)%material%permeability_yy = 1.0e-7_rk
      call expect(s, "&region 'band': permeability is 1.0e-7 m2: ", "permeability of a region")
      s%regions(1)%material%permeability_yy = 1.0e-15_rk
      s%regions(1)%y(3:4) = 0.6_rk
      call expect(s, "&region 'band': width is 0.09524 m: ", "width of a region")
   end subroutine test_regions

   !> Injection into a fracture of a pressed body.
   function sound() result(s)
      type(scene_t) :: s

      s%domain%x_max = 2.0_rk
      s%domain%y_max = 2.0_rk
      s%material%young = 40.0e9_rk
      s%material%poisson = 0.2_rk
      s%material%permeability_xx = 5.0e-20_rk
      s%material%permeability_yy = 5.0e-20_rk
      s%material%toughness = 0.7e6_rk
      s%fluid%viscosity = 1.0e-3_rk
      s%fluid%compressibility = 4.0e-10_rk
      s%fractures = [fracture_t(name="f1", x=[0.9_rk, 1.1_rk], y=[1.0_rk, 1.0_rk], &
                                friction=0.5_rk, dilation=radians, aperture=1.0e-3_rk)]
      s%sides(2)%traction(1) = -20.0e6_rk
      s%sides(4)%traction(2) = -10.0e6_rk
      s%injections = [injection_t(fracture=1, rate=[5.0e-9_rk])]
      s%time%end = 3600.0_rk
      s%time%step = 60.0_rk
      s%output%interval = 60.0_rk
      s%discretization%window = 0.5_rk
      s%growth%enabled = .true.
      s%growth%intensities = .true.
      s%parts = [boundary_part_t ::]
   end function sound

   !> A scene raises one doubt, whose sentence begins with the given words; none if these are empty.
   subroutine expect(s, words, name, again)
      type(scene_t), intent(in) :: s
      character(len=*), intent(in) :: words, name
      logical, intent(in), optional :: again  !< it has been provoked already
      type(text_t), allocatable :: list(:)

      list = doubts_of_scene(s)
      call checks%is_true(size(list) == merge(0, 1, words == ""), name//": how many")
      if (size(list) /= 1) return
      if (.not. present(again)) provoked = provoked + 1
      call checks%is_true(index(list(1)%text, words) == 1, name//": "//list(1)%text)
   end subroutine expect

   subroutine test_material()
      type(scene_t) :: s

      s = sound()
      s%material%permeability_yy = 4.0e-21_rk
      call expect(s, "&material: anisotropy is 12.5: ", "a better conductor one way")
      s = solid
      s%material%poisson = 0.4999_rk
      call expect(s, "&material: poisson is 0.4999: friction then follows", "poisson and friction")
      s%adaptive%enabled = .true.
      call expect(s, "&material: poisson is 0.4999: friction then follows", "with any mesh", .true.)
      s%fractures%law = "frictionless"
      call expect(s, "", "poisson with a mesh that follows the error")
      s%adaptive%enabled = .false.
      call expect(s, "&material: poisson is 0.4999: elements around", "poisson")
      s = solid
      s%material%density = 2.65_rk
      call expect(s, "&material: density is 2.65 kg/m3: ", "density")
      s = scene
      s%material%young = 40.0e9_rk
      s%material%porosity = 1.0_rk
      call expect(s, "&material: porosity is 1.0: ", "porosity")
      s = sound()
      s%material%permeability_xx = 0.1_rk
      s%material%permeability_yy = 0.1_rk
      call expect(s, "&material: permeability is 0.1 m2: ", "permeability")
      s%fluid%viscosity = 0.0_rk
      call expect(s, "", "permeability without a fluid")
      s = sound()
      s%material%toughness = 0.7_rk
      s%injections%fracture = 0  ! in one, viscosity would decide about growth
      call expect(s, "&material: toughness is 0.7 Pa m^1/2: ", "toughness")
      s%growth%enabled = .false.
      call expect(s, "", "toughness without growth")
   end subroutine test_material

   subroutine test_fractures()
      type(scene_t) :: s

      s = sound()
      s%fractures(1)%friction = 1.5_rk
      call expect(s, "", "friction at its bound")
      s%fractures(1)%friction = 1.6_rk
      call expect(s, "&fracture 'f1': friction is 1.6: ", "friction")
      s = sound()
      s%fractures(1)%dilation = 30.0_rk*radians
      call expect(s, "&fracture 'f1': dilation_deg is 30.0 degree: ", "dilation")
      s%fractures(1)%law = "frictionless"
      call expect(s, "", "dilation of another law")
      s = sound()
      s%fractures(1)%aperture = 0.03_rk
      call expect(s, "&fracture 'f1': aperture is 0.03 m: ", "aperture")
      s%fractures(1)%aperture = 0.005_rk
      call expect(s, "", "5 mm")
      s%fractures(1)%aperture = 0.0051_rk
      call expect(s, "&fracture 'f1': aperture is 0.0051 m: natural fractures", "above 5 mm")
      s%fluid%viscosity = 0.0_rk
      call expect(s, "", "above 5 mm without a fluid")
   end subroutine test_fractures

   subroutine test_flow()
      type(scene_t) :: s
      !> k/(mu S), S = phi c + (alpha - phi)/K + alpha^2/M with K = 22.2 GPa, M = 44.4 GPa
      real(rk), parameter :: diffusivity = 5.0e-17_rk/4.6075e-11_rk

      s = sound()
      s%fluid%compressibility = 4.0e-4_rk
      call expect(s, "&fluid: compressibility is 4.0e-4 1/Pa: ", "compressibility")
      s = sound()
      s%material%biot = 0.1_rk
      s%material%porosity = 0.05_rk
      s%fluid%compressibility = 1.0e-12_rk
      call expect(s, "&fluid: compressibility is 1.0e-12 1/Pa: the undr", "Skempton's coefficient")
      s%material%biot = 0.3_rk
      call expect(s, "", "Skempton's coefficient below 1")
      s = sound()
      s%fluid%viscosity = 100.0_rk
      s%growth%enabled = .false.  ! it would not be the toughness that decides
      call expect(s, "&fluid: viscosity is 100.0 Pa s: ", "viscosity")
      s = sound()
      s%sides(4)%traction(2) = 10.0e6_rk
      call expect(s, "&side 'top': traction is 1.0e7 Pa: ", "tension")
      s%injections = [injection_t ::]
      call expect(s, "", "tension without a well")
      s = sound()
      s%sides(1)%traction(1) = 20.0e6_rk
      call expect(s, "", "compression from the left")
      s = sound()
      s%injections%start = 3600.0_rk
      call expect(s, "&injection: start is 3600.0 s: ", "a well that never runs")
      s = sound()
      s%injections(1)%name = "w"
      s%injections(1)%moved = 0.019_rk
      s%injections(1)%next_distance = 0.021_rk
      call expect(s, "", "a tenth of 0.2 m")
      s%injections(1)%next_distance = 0.0199_rk
      call expect(s, "&injection 'w': next distance is 0.0199 m: two fractures", "both near")
      s%injections(1)%moved = 0.021_rk
      s%injections(1)%next_distance = 1.0_rk
      call expect(s, "&injection 'w': distance is 0.021 m: the well is moved", "far away")
      s = sound()
      s%material%biot = 0.7_rk
      s%material%porosity = 0.01_rk
      s%time%end = 0.899_rk**2/diffusivity
      call expect(s, "", "0.9 m from the right side")
      s%time%end = 0.91_rk**2/diffusivity
      call expect(s, "&injection: reach is 0.91 m: the body is sealed", "sealed")
      s%sides(3)%inflow_given = .true.
      call expect(s, "", "sealed on purpose")
      s%sides(3)%inflow_given = .false.
      s%sides(4)%pressure_given = .true.
      call expect(s, "", "a pressure at a side")
      s = sound()
      s%thickness_assumed = .true.
      call expect(s, "&scene: thickness is 1.0 m: rates such as", "thickness")
      s = sound()
      s%growth%enabled = .false.
      s%growth%enabled_assumed = .true.
      call expect(s, "&growth: enabled is .false.: nothing grows", "growth")
      ! K_I of 0.2 m across 10 MPa is 0.7 MPa sqrt(m) at 11.2489 MPa.
      s%growth%enabled_assumed = .false.
      s%sides(1)%displacement_given(1) = .true.
      s%sides(3)%displacement_given(2) = .true.
      s%injections(1)%pressure = [11.2e6_rk]
      call expect(s, "", "below the toughness")
      s%injections(1)%pressure = [11.3e6_rk]
      call expect(s, "&growth of 'f1': K_I is 728600.0 Pa m^1/2: the fracture would", &
                  "it would grow")
      s%injections(1)%rate = [-1.0e-9_rk]
      call expect(s, "", "the lower limit of a producer")
      s = sound()
      s%discretization%window = 2.0_rk
      call expect(s, "&fine: window is 2.0 m: ", "window")
      s = sound()
      s%output%interval = 6.0_rk
      call expect(s, "&output: interval is 6.0 s: ", "interval")
   end subroutine test_flow

   !> Stress and pressure that grow with depth, from 1 km above the body.
   subroutine test_column()
      type(scene_t) :: s, basin

      basin = sound()
      basin%sides(2)%traction = 0.0_rk
      basin%sides(4)%traction = 0.0_rk
      basin%material%density = 2500.0_rk
      basin%fluid%density = 1000.0_rk
      basin%fluid%vapour_pressure = 0.0_rk
      basin%gravity = [0.0_rk, -10.0_rk]
      basin%in_situ%per_y = [18.0e3_rk, 25.0e3_rk]
      basin%in_situ%y_datum = 1000.0_rk
      call expect(basin, "", "a basin")
      s = basin
      s%fluid%density = 3100.0_rk
      s%in_situ%per_y(1) = 32.0e3_rk
      s%in_situ%per_y(2) = 35.0e3_rk
      call expect(s, "&fluid: density is 3100.0 kg/m3: water has", "a heavy fluid")
      s = basin
      s%fluid%density = 0.0_rk
      call expect(s, "&fluid: density is 0.0 kg/m3: its pressure", "a fluid without weight")
      s = basin
      s%in_situ%stress = [-20.0e6_rk, -25.0e6_rk, 0.0_rk]
      s%in_situ%per_y = 0.0_rk
      call expect(s, "&in_situ: syy_per_y is 0.0 Pa/m: the weight then loads", "no gradient")
      s%in_situ%stress = 0.0_rk
      call expect(s, "", "no stress in situ")
      s = basin
      s%in_situ%y_datum = -1000.0_rk
      s%initial%pressure = 2.0e7_rk
      call expect(s, "&in_situ: tension is 2.505e7 Pa: rock at depth", "above the datum")
      s = basin
      s%in_situ%stress = [-20.0e6_rk, -20.0e6_rk, 0.0_rk]
      s%initial%pressure = -1.0e7_rk
      call expect(s, "&initial: pressure is -20000.0 Pa: there is no water table", "a dry top")
      s = basin
      s%initial%pressure = 8.0e6_rk
      call expect(s, "&initial: pressure is 1.798e7 Pa: fractures", "pressure above the stress")
      s%in_situ%stress(3) = 1.0e6_rk
      s%initial%pressure = 7.9e6_rk
      call expect(s, "&initial: pressure is 1.788e7 Pa: fractures", "a principal stress", .true.)
      s = sound()
      s%discretization%size_boundary = 0.1_rk
      allocate (s%temperature)
      s%temperature%face_depth = 1.0e-3_rk
      call expect(s, "&temperature: face_depth is 0.001 m: elements at the face", "a thin front")
      s = sound()
      s%time%tolerance = 0.01_rk
      call expect(s, "", "a usual tolerance")
      s%time%tolerance = 0.03_rk
      call expect(s, "&time: tolerance is 0.03: tips may jump", "a large tolerance")
   end subroutine test_column

end program test_scene_plausible
